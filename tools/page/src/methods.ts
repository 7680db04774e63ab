// The methods of tmcld, what they take and give, and who may call them.
//
// Drawn by tools/page/draw_methods from rpc.discover: change nothing here.

export type Role = "stop" | "observe" | "operate" | "configure";

export interface Methods {
  /** every method, as this daemon has it */
  "rpc.discover": {
    params: Record<string, never>;
    result: {
      /** every method */
      methods: {
        /** what it is called */
        name: string;
        /** what it does */
        summary: string;
        /** what it does to a machine at most: reads, writes, moves or stops */
        effect: string;
        /** who may call it: stop, observe, operate or configure */
        role: string;
        /** what it takes */
        params: {
          /** what it is called */
          name: string;
          /** what it is in JSON */
          type: string;
          /** of a parameter */
          required: boolean | null;
          /** of a parameter that is an integer */
          minimum: number | null;
          /** of a parameter that is an integer */
          maximum: number | null;
          /** what it means */
          summary: string;
          /** of an object, or of each object of an array */
          members: Record<string, unknown>[] | null;
        }[];
        /** what it gives */
        result: {
          /** what it is called */
          name: string;
          /** what it is in JSON */
          type: string;
          /** of a parameter */
          required: boolean | null;
          /** of a parameter that is an integer */
          minimum: number | null;
          /** of a parameter that is an integer */
          maximum: number | null;
          /** what it means */
          summary: string;
          /** of an object, or of each object of an array */
          members: Record<string, unknown>[] | null;
        }[];
      }[];
    };
  };
  /** the configured buses and how they are */
  "bus.list": {
    params: Record<string, never>;
    result: {
      /** the buses */
      buses: {
        /** name of the bus */
        name: string;
        /** how it is reached */
        link: string;
        /** opening, open, lost */
        state: string;
        /** why it is not open */
        error: string | null;
        /** bits a second on its wire; null where it is unknown: TCP, USB, virtual CAN */
        bit_rate: number | null;
        /** since the daemon started */
        counters: {
          /** datagrams sent */
          requests: number;
          /** answers accepted */
          replies: number;
          /** requests without an answer in time */
          timeouts: number;
          /** answers to requests that had been given up; dropped */
          late_replies: number;
          /** answers to nothing that was asked, or from another module; dropped */
          unexpected_replies: number;
          /** bytes that belong to no datagram */
          garbage_bytes: number;
          /** exchanges that proved that a module is in step, or that what it had answered before was right */
          fences: number;
          /** replies beyond what a module was asked for; dropped */
          surplus: number;
          /** answers that were given out only when a further exchange had proven them: on a line that loses, doubles or delays replies, and wherever a movement depends on the value */
          suspect: number;
        };
        /** what came in since it was opened or scanned last; null on CAN */
        heard: {
          /** nothing, answers, wrong_checksums, foreign, echo, text, other_baud_rate, noise */
          kind: string;
          /** how many came in */
          bytes: number;
          /** the first whole line of it, up to 40 characters */
          text: string | null;
          /** the same in a sentence */
          meaning: string;
          /** what to try; absent after answers */
          hint: string | null;
        } | null;
      }[];
    };
  };
  /** what went over a bus lately: the last 4096 datagrams */
  "bus.trace": {
    params: {
      /** name of the bus */
      bus: string;
      /** those behind the one of this number; the newest if absent */
      after?: number;
      /** how many at most; 256 if absent */
      limit?: number;
    };
    result: {
      /** name of the bus */
      bus: string;
      /** number of the newest one that there is */
      last: number;
      /** how many after 'after' are not remembered any more */
      dropped: number;
      /** the oldest first */
      datagrams: {
        /** counts what went over the bus, from 1 on */
        number: number;
        /** when, in microseconds since 1970 */
        utc_us: number;
        /** out: to the modules; in: from them */
        direction: string;
        /** in hexadecimal, as they were on the wire */
        bytes: string;
        /** identifier of the frame, on CAN */
        can_id: number | null;
        /** true: that has 29 bits */
        can_extended: boolean | null;
        /** true: they belong to no datagram */
        garbage: boolean | null;
        /** who asked, or whose question it seems to answer; absent: the daemon itself */
        client: string | null;
      }[];
    };
  };
  /** asks every address who is there; tells its progress by notify_progress */
  "bus.scan": {
    params: {
      /** name of the bus; all buses if absent */
      bus?: string;
      /** first address; 1 if absent */
      first?: number;
      /** last address; 255 if absent, and at most on serial lines */
      last?: number;
    };
    result: {
      /** who has answered */
      modules: {
        /** name of the bus */
        bus: string;
        /** address of the module */
        address: number;
        /** model of the module; null if it has no name */
        model: string | null;
        /** its number */
        model_number: number | null;
        /** its version */
        firmware: string | null;
        /** how many motors it has */
        axes: number | null;
        /** no firmware runs */
        in_bootloader: boolean;
        /** several have this address */
        duplicate_suspected: boolean;
        /** it takes replies for commands */
        address_is_reply_id: boolean;
      }[];
      /** buses that could not be scanned */
      failed: {
        /** name of the bus */
        bus: string;
        /** why it could not be scanned */
        error: Record<string, unknown>;
      }[];
      /** buses on which no module was found */
      silent: {
        /** name of the bus */
        bus: string;
        /** what came in meanwhile; null on CAN */
        heard: {
          /** nothing, answers, wrong_checksums, foreign, echo, text, other_baud_rate, noise */
          kind: string;
          /** how many came in */
          bytes: number;
          /** the first whole line of it, up to 40 characters */
          text: string | null;
          /** the same in a sentence */
          meaning: string;
          /** what to try; absent after answers */
          hint: string | null;
        } | null;
      }[];
    };
  };
  /** looks for what keeps axes from moving, and says what to do */
  "doctor.examine": {
    params: {
      /** an axis, with its module and its bus */
      axis?: string;
      /** a bus, with all that is on it; everything if absent */
      bus?: string;
    };
    result: {
      /** in the order in which to look at them */
      findings: {
        /** its name, such as supply */
        check: string;
        /** the axis, the module (bench:1) or the bus; empty: tmcld itself */
        subject: string;
        /** it keeps axes from moving, or may */
        wrong: boolean;
        /** what is so, in a sentence */
        text: string;
        /** what to do; null where nothing is wrong */
        cure: string | null;
      }[];
    };
  };
  /** the configured modules and how they are */
  "module.list": {
    params: Record<string, never>;
    result: {
      /** the modules */
      modules: {
        /** name of the bus */
        bus: string;
        /** address of the module */
        address: number;
        /** model of the module; null if it has no name */
        model: string | null;
        /** its number */
        model_number: number | null;
        /** its version */
        firmware: string | null;
        /** how many motors it has */
        axes: number | null;
        /** unknown, ready, silent, in_bootloader */
        state: string;
        /** several have this address */
        duplicate_suspected: boolean;
        /** by what it is noticed that it has started again: tick, variable:N, settings, or none */
        watched_by: string;
        /** whether it stops its motors when no host sends it anything: unknown, none, or what a test has found */
        deadman: string | {
          /** what the module is set to */
          ms: number;
          /** after so many milliseconds without a command it has stopped */
          measured: number;
        };
        /** whether they are as in the file that is configured: none (no file), unknown, as_file, differ */
        settings: string;
      }[];
    };
  };
  /** any TMCL command, exactly as given */
  "module.execute": {
    params: {
      /** name of the bus */
      bus: string;
      /** address of the module */
      address: number;
      /** refused instead of sent when it could not be sent so soon after it came in */
      deadline_ms?: number;
      /** TMCL mnemonic or number */
      command: string | number;
      /** type field; 0 if absent */
      type?: string | number;
      /** motor or bank; 0 if absent */
      motor?: number;
      /** value field; 0 if absent */
      value?: number;
    };
    result: {
      /** status byte of the reply */
      status: number;
      /** its standard name */
      status_name: string;
      /** command byte of the reply */
      command: number;
      /** value of the reply */
      value: number;
      /** the firmware version where it came as text */
      text: string | null;
      /** such as that an axis turns for this connection only; null if there are none */
      warnings: string[] | null;
    };
  };
  /** the axes and how they are */
  "axis.list": {
    params: {
      /** also those that were named as BUS:ADDRESS/MOTOR; only configured ones if absent */
      all?: boolean;
    };
    result: {
      /** the axes */
      axes: {
        /** name of the axis */
        name: string;
        /** name of its bus */
        bus: string;
        /** address of its module */
        address: number;
        /** number of its motor */
        motor: number;
        /** model of its module; null if it is not known */
        model: string | null;
        /** unknown, ready, silent, in_bootloader, no_such_motor */
        state: string;
        /** what it measures in; null if the axis has no unit */
        unit: string | null;
        /** what is wrong with its driver or its supply, as axis.get_errors names it */
        faults: string[];
      }[];
    };
  };
  /** starts a move to a position; does not wait for its end */
  "axis.move_to": {
    params: {
      /** name of the axis */
      axis: string;
      /** where to go */
      position_microsteps?: number;
      /** the same, instead; a number: in the axis' unit */
      position?: number | string;
      /** foresee how long it takes; true if absent. Costs two readings, and more after a change of settings */
      predict?: boolean;
      /** refused instead of sent when it could not be sent so soon after it came in */
      deadline_ms?: number;
    };
    result: {
      /** where the move ends */
      target_microsteps: number;
      /** what it measures in; null if the axis has no unit */
      unit: string | null;
      /** where it ends, in the unit */
      target: number | null;
      /** how many seconds it will take; null where it cannot be foreseen */
      predicted_s: number | null;
      /** warnings about its settings, and why the move cannot be foreseen */
      warnings: string[] | null;
    };
  };
  /** starts a move over a distance; does not wait for its end */
  "axis.move_by": {
    params: {
      /** name of the axis */
      axis: string;
      /** how far to go from here */
      distance_microsteps?: number;
      /** the same, instead; a number: in the axis' unit */
      distance?: number | string;
      /** foresee how long it takes; true if absent. Costs two readings, and more after a change of settings */
      predict?: boolean;
      /** refused instead of sent when it could not be sent so soon after it came in */
      deadline_ms?: number;
    };
    result: {
      /** where the move ends */
      target_microsteps: number;
      /** what it measures in; null if the axis has no unit */
      unit: string | null;
      /** where it ends, in the unit */
      target: number | null;
      /** how many seconds it will take; null where it cannot be foreseen */
      predicted_s: number | null;
      /** warnings about its settings, and why the move cannot be foreseen */
      warnings: string[] | null;
    };
  };
  /** turns without end */
  "axis.rotate": {
    params: {
      /** name of the axis */
      axis: string;
      /** speed in the module's own unit; the sign is the direction */
      velocity_internal?: number;
      /** the same, instead; a number: in the axis' unit per second */
      velocity?: number | string;
      /** it turns on when the connection ends; it stops then if absent */
      unattended?: boolean;
      /** refused instead of sent when it could not be sent so soon after it came in */
      deadline_ms?: number;
    };
    result: {
      /** speed in the module's own unit */
      velocity_internal: number;
      /** what it measures in; null if the axis has no unit */
      unit: string | null;
      /** speed in the unit per second */
      velocity: number | null;
      /** such as that it is faster than max_velocity, which holds for positions */
      warnings: string[] | null;
    };
  };
  /** goes one way for as long as it is called again; needs a lease */
  "axis.jog": {
    params: {
      /** name of the axis */
      axis: string;
      /** speed in the module's own unit; the sign is the direction, and 0 ends it */
      velocity_internal?: number;
      /** the same, instead; a number: in the axis' unit per second */
      velocity?: number | string;
      /** for how long it goes on without a further call */
      hold_ms: number;
    };
    result: {
      /** where it comes to rest without a further call */
      target_microsteps: number;
      /** what it measures in; null if the axis has no unit */
      unit: string | null;
      /** the same in the unit */
      target: number | null;
      /** when it begins to brake without a further call, by CLOCK_MONOTONIC of tmcld's computer */
      until_ms: number;
      /** such as that the journal cannot be written */
      warnings: string[] | null;
    };
  };
  /** makes a small move and finds from the encoder how the load swings after it */
  "axis.resonance": {
    params: {
      /** name of the axis */
      axis: string;
      /** how far to move, 1000 full steps at most; a quarter of a turn if absent */
      distance_microsteps?: number;
      /** the same, instead; a number: in the axis' unit */
      distance?: number | string;
      /** for how long the encoder is read then; 1000 if absent */
      listen_ms?: number;
      /** refused instead of sent when it could not be sent so soon after it came in */
      deadline_ms?: number;
    };
    result: {
      /** name of the axis */
      axis: string;
      /** rings: the next three are known; still: its encoder stood as soon as the motor; unclear: it did neither */
      verdict: string;
      /** how fast the load swings behind the motor */
      resonance_hz: number | null;
      /** of its swings, 0 to less than 1 */
      damping: number | null;
      /** how far it swung to either side when the motor had arrived, as its encoder counts */
      swing: number | null;
      /** the part of what the encoder did then that this explains, 0 to 1 */
      confidence: number;
      /** what swings more slowly is not seen in readings over this time */
      lowest_hz: number;
      /** what swings faster is not seen in so few readings a second */
      highest_hz: number;
      /** how many of the encoder */
      readings: number;
      /** the module has recorded them by itself, by command 142; else the bus was asked */
      recorded: boolean;
      /** over which time, in seconds */
      readings_s: number;
      /** how far the move went */
      distance_microsteps: number;
      /** the greatest velocity of the move, in microsteps per second */
      velocity_pps: number;
      /** its acceleration, per second squared */
      acceleration_pps2: number;
      /** warnings about moves with its settings */
      warnings: string[];
    };
  };
  /** ramps down to standstill; goes out before everything else */
  "axis.stop": {
    params: {
      /** name of the axis */
      axis: string;
    };
    result: Record<string, never>;
  };
  /** answers when the axis stands at its target */
  "axis.wait": {
    params: {
      /** name of the axis */
      axis: string;
      /** how long at most; 0 or absent: as it takes */
      timeout_ms?: number;
      /** which target; the one that it has then if absent */
      target_microsteps?: number;
    };
    result: {
      /** where it is */
      position_microsteps: number;
      /** what it measures in; null if the axis has no unit */
      unit: string | null;
      /** where it is, in the unit */
      position: number | null;
      /** warnings about moves with its settings */
      warnings: string[];
    };
  };
  /** gives the client the right to move some axes alone: all of them, or none */
  "lease.acquire": {
    params: {
      /** names of the axes */
      axes: string[];
      /** it ends if it is not renewed so soon; 2000 if absent */
      ttl_ms?: number;
      /** stop: its axes are stopped when it is lost; keep: they are not; stop if absent */
      on_loss?: string;
    };
    result: {
      /** number of the lease */
      lease: number;
      /** proves that a call is made under this lease */
      epoch: number;
      /** its axes */
      axes: string[];
      /** how soon it has to be renewed */
      ttl_ms: number;
      /** that its axes are not stopped if tmcld is killed, and why; null if they are */
      warnings: string[] | null;
    };
  };
  /** says that its holder is still there */
  "lease.renew": {
    params: {
      /** number of the lease */
      lease: number;
      /** what lease.acquire gave with it; only its holder knows that */
      epoch: number;
      /** how soon it has to be renewed again; as before if absent */
      ttl_ms?: number;
    };
    result: {
      /** number of the lease */
      lease: number;
      /** proves that a call is made under this lease */
      epoch: number;
      /** its axes */
      axes: string[];
      /** how soon it has to be renewed */
      ttl_ms: number;
      /** that its axes are not stopped if tmcld is killed, and why; null if they are */
      warnings: string[] | null;
    };
  };
  /** ends it, once its axes have taken a stop */
  "lease.release": {
    params: {
      /** number of the lease */
      lease: number;
      /** what lease.acquire gave with it; only its holder knows that */
      epoch: number;
      /** whether its axes are stopped; true if absent */
      stop?: boolean;
    };
    result: Record<string, never>;
  };
  /** who may move which axes alone */
  "lease.list": {
    params: Record<string, never>;
    result: {
      /** the leases there are */
      leases: {
        /** number of the lease */
        lease: number;
        /** its axes */
        axes: string[];
        /** who has it */
        holder: string;
        /** for how long */
        since_s: number;
        /** when it ends unless it is renewed */
        expires_ms: number;
      }[];
    };
  };
  /** takes the lease of an axis away, as if its time were over */
  "lease.break": {
    params: {
      /** name of the axis */
      axis: string;
    };
    result: Record<string, never>;
  };
  /** makes a token, by which a client is let in */
  "token.add": {
    params: {
      /** what its bearer may do: observe, operate or configure */
      role: string;
      /** what it is called; token-1 or the next one that is free if absent */
      name?: string;
    };
    result: {
      /** what it is called */
      name: string;
      /** what its bearer may do: observe, operate or configure */
      role: string;
      /** the token, which is told this once and kept nowhere */
      token: string;
    };
  };
  /** which tokens there are */
  "token.list": {
    params: Record<string, never>;
    result: {
      /** the tokens there are */
      tokens: {
        /** what it is called */
        name: string;
        /** what its bearer may do: observe, operate or configure */
        role: string;
        /** when it was made, in UTC */
        made: string;
      }[];
    };
  };
  /** makes a code with which one browser signs in by the token, once, within ten minutes */
  "token.invite": {
    params: {
      /** what it is called */
      name: string;
    };
    result: {
      /** what it is called */
      name: string;
      /** what its bearer may do: observe, operate or configure */
      role: string;
      /** signs a browser in once, by POST /session, where the token itself would */
      code: string;
      /** until it does no more */
      ends_in_s: number;
    };
  };
  /** ends the token, and the connections that it let in */
  "token.revoke": {
    params: {
      /** what it is called */
      name: string;
    };
    result: Record<string, never>;
  };
  /** who is connected, by which door, with which role */
  "client.list": {
    params: Record<string, never>;
    result: {
      /** who is connected; who came first is first */
      clients: {
        /** who it is, as other methods tell it */
        client: string;
        /** by which it came: socket; http or websocket; port, where hosts speak TMCL; process, that of the gateway itself */
        door: string;
        /** where it is; null: on this computer */
        address: string | null;
        /** number of its user; null: not of this computer */
        uid: number | null;
        /** its process; null: not of this computer */
        pid: number | null;
        /** name of the token that let it in; null: none did */
        token: string | null;
        /** what it may do: stop, observe, operate or configure */
        role: string;
        /** those that it has leased */
        axes: string[];
        /** for how long it has been connected */
        since_s: number;
        /** its calls that are in progress; this one is among them */
        requests: number;
      }[];
    };
  };
  /** what was moved, set and stopped lately, by whom: the last 1000 lines */
  "audit.tail": {
    params: {
      /** how many at most; 100 if absent */
      lines?: number;
      /** those behind the one of this number; the newest if absent */
      after?: number;
    };
    result: {
      /** number of the newest one that there is */
      last: number;
      /** how many after 'after' are not remembered any more */
      dropped: number;
      /** the oldest first */
      lines: {
        /** counts what was audited since tmcld was started, from 1 on */
        number: number;
        /** when, in microseconds since 1970 */
        utc_us: number;
        /** number of the user; null: the text says who it is */
        uid: number | null;
        /** the process; null: the text says who it is */
        pid: number | null;
        /** what was asked for, and what came of it */
        text: string;
      }[];
    };
  };
  /** where the page for browsers is */
  "page.find": {
    params: Record<string, never>;
    result: {
      /** what a browser takes, such as https://gateway:4143; empty where nothing is served by HTTP */
      addresses: string[];
    };
  };
  /** the part of the configuration that clients may set */
  "configuration.get": {
    params: Record<string, never>;
    result: {
      /** its path, which 'managed' in [daemon] names; null: nothing is set by clients */
      file: string | null;
      /** what stands in it; null: it is not there yet */
      toml: string | null;
    };
  };
  /** sets the part of the configuration that is for clients, and goes by it */
  "configuration.set": {
    params: {
      /** all of it: [[bus]], [[module]], [[axis]] and [path] */
      toml: string;
      /** true: it is only said what would become of it; nothing changes */
      dry_run?: boolean;
    };
    result: {
      /** it is another text than the one before */
      changed: boolean;
      /** in words: what has become of the buses, or would */
      buses: string;
    };
  };
  /** makes the calls of this connection those of a user, from now on */
  "speak_for": {
    params: {
      /** who makes the calls, as audit and leases name them */
      user: string;
      /** what that user may do: stop, observe, operate, configure */
      role: string;
    };
    result: {
      /** who makes the calls, as audit and leases name them */
      user: string;
      /** what that user may do: stop, observe, operate, configure */
      role: string;
    };
  };
  /** moves several axes so that they start and arrive together */
  "line.move": {
    params: {
      /** names of the axes, on any buses */
      axes: string[];
      /** where each of them is to go */
      positions_microsteps?: number[];
      /** the same, instead; a number: in the axis' unit */
      positions?: (number | string)[];
      /** what no axis exceeds; a number: in the unit that all have */
      velocity?: number | string;
      /** the same in microsteps per second, instead */
      velocity_pps?: number;
      /** what no axis exceeds; a number: in the unit that all have */
      acceleration?: number | string;
      /** the same in microsteps per second squared, instead */
      acceleration_pps2?: number;
      /** how long it takes, up to 86400; as short as possible if absent */
      time_s?: number;
      /** refused instead of sent when it could not be sent so soon after it came in */
      deadline_ms?: number;
    };
    result: {
      /** its axes, in the order of the request */
      axes: {
        /** name of the axis */
        axis: string;
        /** where it is to go */
        target_microsteps: number;
        /** the same in its unit */
        target: number | null;
        /** what it measures in; null if the axis has no unit */
        unit: string | null;
        /** when it arrives */
        predicted_s: number;
      }[];
      /** when the last of them arrives */
      predicted_s: number;
      /** how much earlier the first of them does, as predicted */
      spread_s: number;
      /** how far off the line they get, as predicted; a part of the longest way */
      deviation: number;
      /** one command has started them all */
      one_command: boolean;
      /** how long the starts were expected to take */
      predicted_skew_s: number;
      /** from the first start to the last, as the answers tell */
      skew_s: number;
      /** warnings about the settings of its axes */
      warnings: string[] | null;
    };
  };
  /** hands over the next part of a path file */
  "path.stage": {
    params: {
      /** how many bytes were handed over before; 0: a new path */
      offset: number;
      /** the next bytes, in hexadecimal */
      data: string;
    };
    result: {
      /** how many there are now */
      bytes: number;
    };
  };
  /** plans a path, and says what will be run */
  "path.plan": {
    params: {
      /** names of axes that stand, each once; path.plan takes those of the same name as the file's if absent */
      axes?: string[];
      /** which axis of the file each of them is; in the file's order if absent */
      file_axes?: string[];
      /** the file */
      text?: string;
      /** how many were handed over by path.stage, instead */
      bytes?: number;
      /** csv or gcode; as the text looks if absent */
      format?: string;
      /** velocity, segments or position; velocity if absent */
      mode?: string;
      /** how far from it the path may be passed, in the file's unit; 0.05 if absent */
      tolerance?: number;
      /** no axis faster than this; a number: in the file's unit a second; its max_velocity if absent */
      velocity?: number | string;
      /** the same, a second squared; the least of its own if absent */
      acceleration?: number | string;
      /** no faster along the path; a number: in the file's unit a second */
      feed?: number | string;
      /** by how much the speed of an axis may change at once in a corner, in the same units */
      corner_jump?: number | string;
      /** what a turn of the motor is, for axes without a unit */
      per_turn?: number;
      /** stop when an axis is seen so far off its plan; 20 tolerances if absent */
      deviation?: number;
      /** in velocity mode, and by segments, no updates more often than this; 5 if absent */
      period_ms?: number;
      /** whether words of G-code that are not known are skipped, with warnings; refused if absent */
      lenient?: boolean;
      /** by what path.status tells it from others, such as the name of its file */
      name?: string;
      /** zv, zvd or ei: passes the path so that loads which swing at resonance_hz hardly swing after it; takes up to a swing longer, and cuts corners; not in position mode */
      shaper?: string;
      /** for shaper, and for what is told of jerk: as axis.resonance measures it */
      resonance_hz?: number;
      /** of those swings, 0 to less than 1; 0.05 if absent */
      damping?: number;
      /** by how much the acceleration along the path changes in a second, at most; a number: in the file's unit a second cubed; no limit if absent; not in position mode, not for a table with times */
      jerk?: number | string;
      /** how many of the curve are given; none if absent */
      points?: number;
    };
    result: {
      /** by which path.run runs it, once; the daemon keeps the last one */
      plan: number;
      /** in the order of the file's */
      axes: string[];
      /** where it leads, and how fast */
      course: {
        /** of the path */
        length: number;
        /** how long it takes */
        duration_s: number;
        /** how many it has */
        legs: number;
        /** of the file */
        axes: {
          /** of the file */
          axis: string;
          /** least position of it */
          least: number;
          /** greatest position */
          greatest: number;
          /** how fast it gets */
          top_speed: number;
        }[];
        /** where it gets slowest; five at most */
        slowest_corners: {
          /** of the file */
          line: number;
          /** when it is passed */
          time_s: number;
          /** along the path */
          speed: number;
          /** of each axis */
          position: number[];
        }[];
        /** which M words are carried out on it */
        words: {
          /** of the word: 3, 4, 5, 7, 8 or 9 */
          number: number;
          /** how often it is carried out */
          times: number;
          /** of the file, for the first time */
          line: number;
          /** what it switches, as the configuration says it */
          switches: string;
        }[];
        /** how often it waits at M0 until path.resume */
        waits: number;
      };
      /** to draw it; null unless points are asked for */
      curve: {
        /** of its points */
        times_s: number[];
        /** of each axis at each of them */
        positions: number[][];
      } | null;
      /** what is expected in each mode, the one that was asked for first; empty where the ramps of an axis are not described */
      expected: {
        /** velocity, segments or position */
        mode: string;
        /** how far from the path the axes get, in the unit of the file */
        off_path: number;
        /** when they are so far off, in seconds of the course */
        off_path_at_s: number;
        /** where each axis is then */
        off_path_at: number[];
        /** how late on the path they get */
        lag_s: number;
        /** how much of the course was foreseen; of a long one only the beginning */
        foreseen_s: number;
        /** whether off_path stays within the tolerance */
        keeps_tolerance: boolean;
        /** why the path cannot be passed in this mode, or would be ended; null if it can */
        refused: string | null;
      }[];
      /** warnings about the settings of its axes, and what of the file is not carried out */
      warnings: string[];
      /** what the shaper makes of it; null without one */
      shaping: {
        /** zv, zvd or ei */
        shaper: string;
        /** which it is for */
        resonance_hz: number;
        /** of those swings */
        damping: number;
        /** than the path takes without it */
        longer_s: number;
        /** how far it leaves the path at most: it cuts corners */
        off_path: number;
        /** when that is, in seconds of the course */
        off_path_at_s: number;
        /** what it leaves of their swings */
        axes: {
          /** of the file */
          axis: string;
          /** of its load after the path, to either side */
          swing: number;
          /** the same without the shaper */
          unshaped_swing: number;
        }[];
      } | null;
      /** what the jerk makes of it; null without one */
      jerk: {
        /** along the path, at most */
        jerk: number;
        /** than the path takes without it */
        longer_s: number;
        /** of the loads that are told of; null: none */
        resonance_hz: number | null;
        /** what it leaves of their swings */
        axes: {
          /** of the file */
          axis: string;
          /** of its load after the path, to either side */
          swing: number;
          /** the same without the jerk */
          unlimited_swing: number;
        }[];
      } | null;
    };
  };
  /** moves axes along a path and answers at its end; tells its progress by notify_progress */
  "path.run": {
    params: {
      /** names of axes that stand, each once; path.plan takes those of the same name as the file's if absent */
      axes?: string[];
      /** which axis of the file each of them is; in the file's order if absent */
      file_axes?: string[];
      /** the file */
      text?: string;
      /** how many were handed over by path.stage, instead */
      bytes?: number;
      /** csv or gcode; as the text looks if absent */
      format?: string;
      /** velocity, segments or position; velocity if absent */
      mode?: string;
      /** how far from it the path may be passed, in the file's unit; 0.05 if absent */
      tolerance?: number;
      /** no axis faster than this; a number: in the file's unit a second; its max_velocity if absent */
      velocity?: number | string;
      /** the same, a second squared; the least of its own if absent */
      acceleration?: number | string;
      /** no faster along the path; a number: in the file's unit a second */
      feed?: number | string;
      /** by how much the speed of an axis may change at once in a corner, in the same units */
      corner_jump?: number | string;
      /** what a turn of the motor is, for axes without a unit */
      per_turn?: number;
      /** stop when an axis is seen so far off its plan; 20 tolerances if absent */
      deviation?: number;
      /** in velocity mode, and by segments, no updates more often than this; 5 if absent */
      period_ms?: number;
      /** whether words of G-code that are not known are skipped, with warnings; refused if absent */
      lenient?: boolean;
      /** by what path.status tells it from others, such as the name of its file */
      name?: string;
      /** zv, zvd or ei: passes the path so that loads which swing at resonance_hz hardly swing after it; takes up to a swing longer, and cuts corners; not in position mode */
      shaper?: string;
      /** for shaper, and for what is told of jerk: as axis.resonance measures it */
      resonance_hz?: number;
      /** of those swings, 0 to less than 1; 0.05 if absent */
      damping?: number;
      /** by how much the acceleration along the path changes in a second, at most; a number: in the file's unit a second cubed; no limit if absent; not in position mode, not for a table with times */
      jerk?: number | string;
      /** what path.plan has planned, instead of all but to_start and points */
      plan?: number;
      /** whether the axes go to the start first; they must stand there if absent */
      to_start?: boolean;
      /** how many of the places where the axes are seen are given, to draw them; none if absent */
      points?: number;
    };
    result: {
      /** how long it took */
      passed_s: number;
      /** of velocities; of segments; legs in position mode */
      updates: number;
      /** between updates; the least that a segment takes; of the shortest leg in position mode */
      period_ms: number;
      /** of an update, or of the load of a leg */
      worst_delay_ms: number;
      /** sent meanwhile */
      commands: number;
      /** of them */
      commands_per_s: number;
      /** part of the time that they took */
      bus_load: number;
      /** of a command, measured before */
      round_trip_us: number;
      /** of each axis */
      tracking_error: {
        /** how far off its plan it was seen */
        largest: number;
        /** root of the mean square */
        rms: number;
        /** how often it was looked at */
        readings: number;
        /** name of the axis */
        axis: string;
      }[];
      /** how far from the path the axes were seen at most, in the unit of the file; between two readings they may have been farther off */
      off_path: number;
      /** when that was, in seconds of the course */
      off_path_at_s: number;
      /** where each axis was then */
      off_path_at: number[];
      /** how late on the path they were seen at most */
      lag_s: number;
      /** by how much off_path is more than the tolerance, at least; null if it is not */
      tolerance_exceeded_by: number | null;
      /** what else is to be said, such as of a parameter not set back */
      remarks: string[];
      /** where the axes were seen, over the course; null unless points are asked for */
      seen: {
        /** of its points */
        times_s: number[];
        /** of each axis at each of them */
        positions: number[][];
      } | null;
      /** the nearest point of the path to each of these */
      on_path: {
        /** of its points */
        times_s: number[];
        /** of each axis at each of them */
        positions: number[][];
      } | null;
      /** the same by the encoders of the axes; null unless the configuration names one, and it was read */
      motors: {
        /** of each axis that has an encoder */
        tracking_error: {
          /** how far off its plan it was seen */
          largest: number;
          /** root of the mean square */
          rms: number;
          /** how often it was looked at */
          readings: number;
          /** name of the axis */
          axis: string;
        }[];
        /** how far from the path the motors were seen at most, in the unit of the file; where an axis has no encoder, its position counts */
        off_path: number;
        /** when that was, in seconds of the course */
        off_path_at_s: number;
        /** where each motor was then */
        off_path_at: number[];
        /** how late on the path they were seen at most */
        lag_s: number;
        /** by how much off_path is more than the tolerance, at least; null if it is not */
        tolerance_exceeded_by: number | null;
        /** where the motors were seen, over the course; null unless points are asked for */
        seen: {
          /** of its points */
          times_s: number[];
          /** of each axis at each of them */
          positions: number[][];
        } | null;
        /** the nearest point of the path to each of these */
        on_path: {
          /** of its points */
          times_s: number[];
          /** of each axis at each of them */
          positions: number[][];
        } | null;
      } | null;
      /** warnings about the settings of its axes, and what of the file is not carried out */
      warnings: string[];
      /** what was expected before it began, as path.plan says; empty of a path that was planned before */
      expected: {
        /** velocity, segments or position */
        mode: string;
        /** how far from the path the axes get, in the unit of the file */
        off_path: number;
        /** when they are so far off, in seconds of the course */
        off_path_at_s: number;
        /** where each axis is then */
        off_path_at: number[];
        /** how late on the path they get */
        lag_s: number;
        /** how much of the course was foreseen; of a long one only the beginning */
        foreseen_s: number;
        /** whether off_path stays within the tolerance */
        keeps_tolerance: boolean;
        /** why the path cannot be passed in this mode, or would be ended; null if it can */
        refused: string | null;
      }[];
    };
  };
  /** lets axes stand on their path */
  "path.pause": {
    params: {
      /** of paths; all paths if absent */
      axes?: string[];
    };
    result: {
      /** of the paths concerned */
      axes: string[];
    };
  };
  /** lets them go on, also from M0 */
  "path.resume": {
    params: {
      /** of paths; all paths if absent */
      axes?: string[];
    };
    result: {
      /** of the paths concerned */
      axes: string[];
    };
  };
  /** how far the paths of some axes are, and how fast */
  "path.status": {
    params: {
      /** of paths; all paths if absent */
      axes?: string[];
    };
    result: {
      /** those concerned */
      paths: {
        /** in the order of the file's */
        axes: string[];
        /** what path.run calls it */
        name: string | null;
        /** velocity, segments or position */
        mode: string;
        /** approaching, measuring, running, pausing, waiting or ending */
        phase: string;
        /** how much of its course has been passed, in seconds of that */
        passed_s: number;
        /** how long the course takes as it was planned */
        duration_s: number;
        /** what part of it has been passed; 0 to 1 */
        done: number;
        /** how long the rest takes with the present override, or with 1 if that is greater; null while it is held */
        left_s: number | null;
        /** of the file, on which it is; null in a table with times */
        line: number | null;
        /** whether it stands on its path, or is about to */
        held: boolean;
        /** the override: what part of the planned speed is asked for */
        factor: number;
        /** what there is of it now; less than is asked for while it changes, and where an axis can do no more */
        factor_now: number;
        /** the speed that the course has here */
        planned_feed: number;
        /** the speed that there is: factor_now of it */
        feed: number;
        /** how far from the path the axes were seen so far */
        off_path: number;
        /** when that was, in seconds of the course */
        off_path_at_s: number;
        /** how late on the path they were seen so far */
        lag_s: number;
        /** of the file, of the M0 at which it waits until path.resume; null if it does not */
        waits_at_line: number | null;
      }[];
    };
  };
  /** slows paths down, speeds them up, holds them and lets them go on */
  "path.feed": {
    params: {
      /** of paths; all paths if absent */
      axes?: string[];
      /** the override, 0.1 to 2: what part of the planned speed is asked for */
      factor?: number;
      /** whether they stand on their path; false: they go on */
      hold?: boolean;
    };
    result: {
      /** those concerned */
      paths: {
        /** in the order of the file's */
        axes: string[];
        /** what path.run calls it */
        name: string | null;
        /** velocity, segments or position */
        mode: string;
        /** approaching, measuring, running, pausing, waiting or ending */
        phase: string;
        /** how much of its course has been passed, in seconds of that */
        passed_s: number;
        /** how long the course takes as it was planned */
        duration_s: number;
        /** what part of it has been passed; 0 to 1 */
        done: number;
        /** how long the rest takes with the present override, or with 1 if that is greater; null while it is held */
        left_s: number | null;
        /** of the file, on which it is; null in a table with times */
        line: number | null;
        /** whether it stands on its path, or is about to */
        held: boolean;
        /** the override: what part of the planned speed is asked for */
        factor: number;
        /** what there is of it now; less than is asked for while it changes, and where an axis can do no more */
        factor_now: number;
        /** the speed that the course has here */
        planned_feed: number;
        /** the speed that there is: factor_now of it */
        feed: number;
        /** how far from the path the axes were seen so far */
        off_path: number;
        /** when that was, in seconds of the course */
        off_path_at_s: number;
        /** how late on the path they were seen so far */
        lag_s: number;
        /** of the file, of the M0 at which it waits until path.resume; null if it does not */
        waits_at_line: number | null;
      }[];
    };
  };
  /** ends paths: answers when their axes stand and have their settings again */
  "path.stop": {
    params: {
      /** of paths; all paths if absent */
      axes?: string[];
    };
    result: {
      /** of the paths concerned */
      axes: string[];
    };
  };
  /** moves axes as a Mint program says and answers at its end; tells its progress by notify_progress */
  "mint.run": {
    params: {
      /** names of axes that stand; each once */
      axes: string[];
      /** which axis of the program each of them is; 0, 1, ... if absent */
      numbers?: number[];
      /** what SCALE counts: microsteps or encoder, its counts; microsteps if absent */
      counts?: string;
      /** the program */
      text?: string;
      /** how many were handed over by path.stage, instead */
      bytes?: number;
    };
    result: {
      /** one for each GO */
      groups: {
        /** of its GO */
        line: number;
        /** how long it was to take */
        planned_s: number;
        /** how long it took */
        took_s: number;
      }[];
      /** what else is to be said, such as of a parameter not set back */
      remarks: string[];
    };
  };
  /** what its movements can be foreseen from */
  "axis.get_ramp": {
    params: {
      /** name of the axis */
      axis: string;
      /** true: answer also while it moves */
      in_motion?: boolean;
    };
    result: {
      /** model of its module */
      model: string;
      /** where it stands; with `in_motion`, where it was a moment ago */
      position_microsteps: number;
      /** every parameter that makes a difference to its ramps, in the order in which to give them to its twin */
      settings: {
        /** standard name of the axis parameter */
        parameter: string;
        /** its number */
        number: number;
        /** what it is set to */
        value: number;
      }[];
      /** what the configuration says of its module */
      traits: {
        /** as a report of axis.verify names it, such as last_step */
        trait: string;
        /** which one the module has, such as r3 */
        variant: string;
      }[];
    };
  };
  /** chooses the parameters that make a ramp; writes nothing */
  "axis.plan_ramp": {
    params: {
      /** name of the axis */
      axis: string;
      /** of positioning moves; a number: in the axis' unit per second */
      velocity?: number | string;
      /** the same, instead, in the module's own unit */
      velocity_internal?: number;
      /** of every ramp; a number: in the axis' unit per second squared */
      acceleration?: number | string;
      /** the same, instead, in the module's own unit */
      acceleration_internal?: number;
      /** to brake with, where the module has it apart; as the acceleration if absent */
      deceleration?: number | string;
      /** the same, instead, in the module's own unit */
      deceleration_internal?: number;
      /** how fast the acceleration may change; a number: in the axis' unit per second cubed; 'max': as fast as it can without swinging; as it is if absent */
      jerk?: number | string;
      /** the same, instead, as a TMC457 counts it */
      bow?: number;
    };
    result: {
      /** name of the axis */
      axis: string;
      /** model of its module */
      model: string;
      /** what it measures in; null if the axis has no unit */
      unit: string | null;
      /** what the settings give, in microsteps per second */
      velocity_pps: number;
      /** the same in the unit per second */
      velocity: number | null;
      /** the same, per second squared */
      acceleration_pps2: number;
      /** the same in the unit */
      acceleration: number | null;
      /** the same, of braking */
      deceleration_pps2: number;
      /** the same in the unit */
      deceleration: number | null;
      /** the same, per second cubed; null for an acceleration that changes at once */
      jerk_pps3: number | null;
      /** the same in the unit */
      jerk: number | null;
      /** how long it takes to get up to speed */
      ramp_s: number;
      /** how far it goes meanwhile */
      ramp_microsteps: number;
      /** what makes the ramp */
      settings: {
        /** standard name of the axis parameter */
        parameter: string;
        /** its number */
        number: number;
        /** what it is set to */
        value: number;
      }[];
      /** what it will do instead where the module cannot do what was asked */
      remarks: string[];
      /** warnings about moves with its settings */
      warnings: string[];
    };
  };
  /** chooses them, and sets them on an axis that stands */
  "axis.set_ramp": {
    params: {
      /** name of the axis */
      axis: string;
      /** of positioning moves; a number: in the axis' unit per second */
      velocity?: number | string;
      /** the same, instead, in the module's own unit */
      velocity_internal?: number;
      /** of every ramp; a number: in the axis' unit per second squared */
      acceleration?: number | string;
      /** the same, instead, in the module's own unit */
      acceleration_internal?: number;
      /** to brake with, where the module has it apart; as the acceleration if absent */
      deceleration?: number | string;
      /** the same, instead, in the module's own unit */
      deceleration_internal?: number;
      /** how fast the acceleration may change; a number: in the axis' unit per second cubed; 'max': as fast as it can without swinging; as it is if absent */
      jerk?: number | string;
      /** the same, instead, as a TMC457 counts it */
      bow?: number;
      /** keeps them in the module's EEPROM, too */
      store?: boolean;
    };
    result: {
      /** name of the axis */
      axis: string;
      /** model of its module */
      model: string;
      /** what it measures in; null if the axis has no unit */
      unit: string | null;
      /** what the settings give, in microsteps per second */
      velocity_pps: number;
      /** the same in the unit per second */
      velocity: number | null;
      /** the same, per second squared */
      acceleration_pps2: number;
      /** the same in the unit */
      acceleration: number | null;
      /** the same, of braking */
      deceleration_pps2: number;
      /** the same in the unit */
      deceleration: number | null;
      /** the same, per second cubed; null for an acceleration that changes at once */
      jerk_pps3: number | null;
      /** the same in the unit */
      jerk: number | null;
      /** how long it takes to get up to speed */
      ramp_s: number;
      /** how far it goes meanwhile */
      ramp_microsteps: number;
      /** what makes the ramp */
      settings: {
        /** standard name of the axis parameter */
        parameter: string;
        /** its number */
        number: number;
        /** what it is set to */
        value: number;
      }[];
      /** what it will do instead where the module cannot do what was asked */
      remarks: string[];
      /** warnings about moves with its settings */
      warnings: string[];
    };
  };
  /** what the ramps of an axis that stands make of a move and of a load that swings */
  "ramp.compare": {
    params: {
      /** name of the axis */
      axis: string;
      /** of positioning moves; a number: in the axis' unit per second */
      velocity?: number | string;
      /** the same, instead, in the module's own unit */
      velocity_internal?: number;
      /** of every ramp; a number: in the axis' unit per second squared */
      acceleration?: number | string;
      /** the same, instead, in the module's own unit */
      acceleration_internal?: number;
      /** to brake with, where the module has it apart; as the acceleration if absent */
      deceleration?: number | string;
      /** the same, instead, in the module's own unit */
      deceleration_internal?: number;
      /** how fast the acceleration may change; a number: in the axis' unit per second cubed; 'max': as fast as it can without swinging; as it is if absent */
      jerk?: number | string;
      /** the same, instead, as a TMC457 counts it */
      bow?: number;
      /** how far the move goes */
      distance_microsteps?: number;
      /** the same, instead; a number: in the axis' unit */
      distance?: number | string;
      /** how fast the load swings behind the motor, 0.01 to 100000; no load if absent */
      resonance_hz?: number;
      /** of its swings, 0 to 0.999; 0.05 if absent */
      damping?: number;
      /** within which the load is to stand; a thousandth of the distance if absent */
      tolerance_microsteps?: number;
      /** the same, instead; a number: in the axis' unit */
      tolerance?: number | string;
    };
    result: {
      /** name of the axis */
      axis: string;
      /** model of its module */
      model: string;
      /** what it measures in; null if the axis has no unit */
      unit: string | null;
      /** how far the move goes */
      distance_microsteps: number;
      /** within which the load is to stand; null without a load */
      tolerance_microsteps: number | null;
      /** the steepest first */
      ramps: {
        /** what makes it, beside the velocity and the accelerations that all have */
        settings: {
          /** standard name of the axis parameter */
          parameter: string;
          /** its number */
          number: number;
          /** what it is set to */
          value: number;
        }[];
        /** how long the move takes; null where it does not come to rest on its target */
        move_s: number | null;
        /** the longest part of it in which the speed changes one way */
        longest_phase_s: number;
        /** how far the load swings to either side when the motor has arrived; null without one */
        swing_microsteps: number | null;
        /** the same in the unit */
        swing: number | null;
        /** when the load swings by no more than the tolerance; null if it never does */
        settled_s: number | null;
      }[];
      /** which of them, from 0 on, has its load stand first; null without a load */
      proposed: number | null;
    };
  };
  /** finds the gentlest ramp that makes a move in time, or the quickest that a motor can drive; writes nothing */
  "ramp.find": {
    params: {
      /** name of the axis */
      axis: string;
      /** how far the move goes */
      distance_microsteps?: number;
      /** the same, instead; a number: in the axis' unit */
      distance?: number | string;
      /** how long the move may take, 0.000001 to 86400; the quickest ramp if absent */
      time_s?: number;
      /** no faster than this; a number: in the axis' unit per second; the greatest of the model if absent */
      velocity?: number | string;
      /** the same, instead, in the module's own unit */
      velocity_internal?: number;
      /** as that of axis.plan_ramp */
      jerk?: number | string;
      /** the same, instead, as a TMC457 counts it */
      bow?: number;
      /** that the motor drives at every speed, in 1/1000 of the torque that it holds; 0 if absent, as the next two */
      load?: number;
      /** friction: more of it for each full step per second, in 1/1000 */
      load_per_velocity?: number;
      /** more of it for each full step per second squared, in 1/1000000 */
      inertia?: number;
      /** full steps per second above which the torque of the motor falls; never if absent */
      corner_speed?: number;
      /** torque that is left, as a part of what is asked, 0 to 100; 0.3 if absent */
      margin?: number;
    };
    result: {
      /** name of the axis */
      axis: string;
      /** model of its module */
      model: string;
      /** what it measures in; null if the axis has no unit */
      unit: string | null;
      /** what the settings give, in microsteps per second */
      velocity_pps: number;
      /** the same in the unit per second */
      velocity: number | null;
      /** the same, per second squared */
      acceleration_pps2: number;
      /** the same in the unit */
      acceleration: number | null;
      /** the same, of braking */
      deceleration_pps2: number;
      /** the same in the unit */
      deceleration: number | null;
      /** the same, per second cubed; null for an acceleration that changes at once */
      jerk_pps3: number | null;
      /** the same in the unit */
      jerk: number | null;
      /** how long it takes to get up to speed */
      ramp_s: number;
      /** how far it goes meanwhile */
      ramp_microsteps: number;
      /** what makes the ramp */
      settings: {
        /** standard name of the axis parameter */
        parameter: string;
        /** its number */
        number: number;
        /** what it is set to */
        value: number;
      }[];
      /** what it will do instead where the module cannot do what was asked */
      remarks: string[];
      /** warnings about moves with its settings */
      warnings: string[];
      /** how far the move goes */
      distance_microsteps: number;
      /** how long it takes */
      move_s: number;
      /** how fast it gets, in microsteps per second */
      top_speed_pps: number;
      /** the same in the unit per second */
      top_speed: number | null;
      /** the greatest part that it asks for of the torque that is there at its speed; null without figures of a motor */
      torque_share: number | null;
      /** the speed at which that is */
      torque_share_pps: number | null;
    };
  };
  /** a move as the ramp generator of a model makes it, of a module that need not be there */
  "profile.simulate": {
    params: {
      /** such as TMCM-6212 */
      model: string;
      /** names or numbers of axis parameters that are set, in this order; the others are as the module starts */
      parameters?: string[];
      /** what each of them is set to, as the module counts */
      values?: number[];
      /** how far the move goes, from rest */
      distance_microsteps: number;
      /** how long the curve is, 0.000001 to 86400; until the motor stands if absent */
      until_s?: number;
      /** how many of the curve are given; none if absent */
      points?: number;
      /** how fast a load swings behind the motor, 0.01 to 100000; no load if absent */
      resonance_hz?: number;
      /** of its swings, 0 to 0.999; 0.05 if absent */
      damping?: number;
      /** within which the load is to stand; a thousandth of the distance if absent */
      tolerance_microsteps?: number;
    };
    result: {
      /** model of the module */
      model: string;
      /** how long the move takes; null where it does not come to rest on its target */
      move_s: number | null;
      /** the longest part of it in which the speed changes one way */
      longest_phase_s: number;
      /** how fast it gets, in microsteps per second */
      top_speed_pps: number;
      /** how far the load swings to either side when the motor has arrived; null without one */
      swing_microsteps: number | null;
      /** when the load swings by no more than the tolerance; null if it never does */
      settled_s: number | null;
      /** to draw it; null unless points are asked for */
      curve: {
        /** of its points */
        times_s: number[];
        /** where the motor is at each of them */
        positions_microsteps: number[];
        /** how fast */
        velocities_pps: number[];
        /** and how that changes */
        accelerations_pps2: number[];
      } | null;
      /** warnings about moves with its settings */
      warnings: string[];
    };
  };
  /** all of a trapezoid from as much of it as determines it; asks no module */
  "profile.solve": {
    params: {
      /** what is known, in any unit of length, the same for all, and seconds */
      distance?: number;
      /** the greatest */
      speed?: number;
      /** from the initial speed to that */
      acceleration?: number;
      /** from that to the final speed, as a positive number */
      deceleration?: number;
      /** how long it speeds up */
      acceleration_time?: number;
      /** how long it keeps its speed */
      slew_time?: number;
      /** how long it slows down */
      deceleration_time?: number;
      /** all of them */
      total_time?: number;
      /** with which it begins; 0 if absent */
      initial_speed?: number;
      /** with which it ends; 0 if absent */
      final_speed?: number;
      /** how far it goes while it speeds up */
      acceleration_distance?: number;
      /** at its speed */
      slew_distance?: number;
      /** while it slows down */
      deceleration_distance?: number;
      /** symmetric: both ramps are equal; thirds: each of the three parts takes a third of the time; none if absent */
      assumption?: string;
    };
    result: {
      /** how far it goes */
      distance: number;
      /** the greatest */
      speed: number;
      /** from the initial speed to that */
      acceleration: number;
      /** from that to the final speed, as a positive number */
      deceleration: number;
      /** how long it speeds up */
      acceleration_time: number;
      /** how long it keeps its speed */
      slew_time: number;
      /** how long it slows down */
      deceleration_time: number;
      /** all of them */
      total_time: number;
      /** with which it begins */
      initial_speed: number;
      /** with which it ends */
      final_speed: number;
      /** how far it goes while it speeds up */
      acceleration_distance: number;
      /** at its speed */
      slew_distance: number;
      /** while it slows down */
      deceleration_distance: number;
    };
  };
  /** searches the reference and answers when that has ended */
  "axis.home": {
    params: {
      /** name of the axis */
      axis: string;
      /** axis parameter 193, set before; as it is set if absent */
      mode?: number;
      /** how long at most; 0 or absent: as it takes */
      timeout_ms?: number;
      /** how far it may go one way without turning; as the configuration says if absent */
      max_travel_microsteps?: number;
      /** the same, instead; a number: in the axis' unit */
      max_travel?: number | string;
      /** the search goes on after the timeout; it is stopped then if absent */
      leave?: boolean;
    };
    result: {
      /** where the axis believed to be at what is zero now; null if the module does not say */
      correction_microsteps: number | null;
      /** from one end switch to the other; null if this search did not visit both, or the module does not say */
      switch_distance_microsteps: number | null;
      /** what it measures in; null if the axis has no unit */
      unit: string | null;
      /** the same correction in the unit */
      correction: number | null;
      /** the same way between the switches */
      switch_distance: number | null;
      /** how far it may go one way without turning: it is stopped beyond that; null: nothing bounds it */
      max_travel_microsteps: number | null;
      /** the same in the unit */
      max_travel: number | null;
      /** such as that nothing bounds the search */
      warnings: string[];
    };
  };
  /** starts a reference search; does not wait for its end */
  "axis.start_home": {
    params: {
      /** name of the axis */
      axis: string;
      /** axis parameter 193, set before; as it is set if absent */
      mode?: number;
      /** how far it may go one way without turning; as the configuration says if absent */
      max_travel_microsteps?: number;
      /** the same, instead; a number: in the axis' unit */
      max_travel?: number | string;
    };
    result: {
      /** how far it may go one way without turning: it is stopped beyond that; null: nothing bounds it */
      max_travel_microsteps: number | null;
      /** what it measures in; null if the axis has no unit */
      unit: string | null;
      /** the same in the unit */
      max_travel: number | null;
      /** such as that nothing bounds the search */
      warnings: string[];
    };
  };
  /** ends a reference search */
  "axis.stop_home": {
    params: {
      /** name of the axis */
      axis: string;
    };
    result: Record<string, never>;
  };
  /** says that an axis may move again whose module is not what it was */
  "axis.recover": {
    params: {
      /** name of the axis */
      axis: string;
    };
    result: Record<string, never>;
  };
  /** sets the deadman of the module of an axis, in its EEPROM */
  "axis.set_deadman": {
    params: {
      /** name of the axis */
      axis: string;
      /** it stops its motors after so long; 0: off, or 100 and more */
      ms: number;
    };
    result: {
      /** what its module is set to now; 0: off */
      ms: number;
    };
  };
  /** moves an axis slowly, sends its module nothing, and measures when it stops */
  "axis.test_deadman": {
    params: {
      /** name of the axis */
      axis: string;
    };
    result: {
      /** none, or what was found */
      deadman: string | {
        /** what the module is set to */
        ms: number;
        /** after so many milliseconds without a command it has stopped */
        measured: number;
      };
      /** why there is none */
      reason: string | null;
      /** how far the axis has gone */
      way_microsteps: number;
    };
  };
  /** finds by trials the greatest velocity and acceleration that an axis bears */
  "axis.tune": {
    params: {
      /** name of the axis */
      axis: string;
      /** of parameter 6: no more flows in the trials */
      max_current: number;
      /** how far it may go down from where it stands: 0 or less; to its soft limits if absent */
      from_microsteps?: number;
      /** the same, instead; a number: in the axis' unit */
      from?: number | string;
      /** how far it may go up from there: 0 or more */
      to_microsteps?: number;
      /** the same, instead; a number: in the axis' unit */
      to?: number | string;
      /** so much more than what is proposed has held, in parts; 0.2 if absent */
      margin?: number;
      /** sets what is proposed, and keeps it in the EEPROM of its module */
      store?: boolean;
      /** left or right: the limit switch that tells lost steps; the encoder does if absent */
      by_switch?: string;
    };
    result: {
      /** name of the axis */
      axis: string;
      /** in microsteps per second, with the acceleration of the axis */
      velocity: {
        /** the greatest that held, or of the current the least */
        limit: number;
        /** with the margin */
        proposed: number;
        /** motor: a trial beyond it failed; travel: that is too short for more; bounds: those of the axis and of its module */
        limited_by: string;
      };
      /** per second squared, at the proposed velocity */
      acceleration: {
        /** the greatest that held, or of the current the least */
        limit: number;
        /** with the margin */
        proposed: number;
        /** motor: a trial beyond it failed; travel: that is too short for more; bounds: those of the axis and of its module */
        limited_by: string;
      };
      /** of parameter 6, for both that are proposed */
      current: {
        /** the greatest that held, or of the current the least */
        limit: number;
        /** with the margin */
        proposed: number;
        /** motor: a trial beyond it failed; travel: that is too short for more; bounds: those of the axis and of its module */
        limited_by: string;
      };
      /** of stallGuard2: the least with which the load value keeps off 0 by a tenth of its range; null where the module has none, or none does */
      threshold: number | null;
      /** between motor and encoder, in microsteps */
      backlash: number;
      /** of the encoder; below 0 if it counts the other way */
      counts_per_microstep: number;
      /** the position of the axis was set again, by its encoder or switch: search the reference */
      lost_steps: boolean;
      /** all that were made, in their order */
      trials: {
        /** velocity, acceleration, current, threshold, confirmation, hold, or bow */
        sought: string;
        /** in microsteps per second */
        velocity_pps: number;
        /** per second squared */
        acceleration_pps2: number;
        /** of parameter 6; for hold, of parameter 7 */
        current: number;
        /** the encoder was where the motor should be, there and back */
        held: boolean;
        /** the greatest that the encoder had, in microsteps */
        deviation: number;
        /** the least at full speed, where it was read */
        load_value: number | null;
        /** of stallGuard2, with which that was */
        threshold: number | null;
        /** why it did not hold; empty if it did */
        trouble: string;
        /** of the load at rest, to either side, in microsteps, where it was looked at */
        swing: number | null;
      }[];
      /** what is proposed, in the order to set it */
      settings: {
        /** its number */
        parameter: number;
        /** of the parameter */
        name: string;
        /** what is proposed */
        value: number;
        /** what the axis has */
        before: number;
      }[];
      /** they are set, and in the module's EEPROM where that keeps them */
      stored: boolean;
      /** about what was found */
      warnings: string[];
      /** of parameter 7, with which the axis stands; bounds: nothing moved it with less either, and what it has is proposed; null where the module has none, or none was enough */
      hold_current: {
        /** the greatest that held, or of the current the least */
        limit: number;
        /** with the margin */
        proposed: number;
        /** motor: a trial beyond it failed; travel: that is too short for more; bounds: those of the axis and of its module */
        limited_by: string;
      } | null;
      /** with which the load stands first; null where the module has none */
      bow: {
        /** what is proposed; what the axis has where no other is better */
        value: number;
        /** of the load; null where none was found */
        resonance_hz: number | null;
        /** 0 to less than 1 */
        damping: number | null;
        /** with it, at rest, to either side, in microsteps */
        swing: number;
        /** with the bow that the axis has */
        swing_before: number;
      } | null;
    };
  };
  /** moves an axis a little, and finds out in what its module is not like its twin */
  "axis.verify": {
    params: {
      /** name of the axis */
      axis: string;
      /** how far it may go down from where it stands: 0 or less; to its soft limits if absent */
      from_microsteps?: number;
      /** the same, instead; a number: in the axis' unit */
      from?: number | string;
      /** how far it may go up from there: 0 or more */
      to_microsteps?: number;
      /** the same, instead; a number: in the axis' unit */
      to?: number | string;
    };
    result: {
      /** of the module */
      model: string;
      /** its version */
      firmware: string;
      /** how quickly it has answered at best, without what the wire takes; null on CAN */
      answer_us: number | null;
      /** those that make a difference to its model */
      traits: {
        /** such as last_step: a key of a file for tmclsim --as */
        trait: string;
        /** the variant that its twin has */
        foreseen: string;
        /** it was tried what the module does */
        measured: boolean;
        /** which variants do; none of those that are known, if it was tried and nothing is here */
        fits: string[];
        /** what was seen, or why it was not tried */
        text: string;
      }[];
      /** those that told variants of its chip apart */
      moves: {
        /** how far */
        distance_microsteps: number;
        /** what the ramp generator was set to */
        settings: string;
        /** how long its twin takes */
        foreseen_s: number;
        /** it took longer than this */
        least_s: number;
        /** and no longer than this */
        most_s: number;
      }[];
      /** all this as a text: the file that tmclsim --as and 'as' in [[module]] take */
      report: string;
    };
  };
  /** has the module of an axis record parameters of it, by command 142 */
  "capture.start": {
    params: {
      /** name of the axis */
      axis: string;
      /** names or numbers of the axis parameters to record */
      channels: string[];
      /** how many samples a second; as many as the module can if it is not given */
      rate_hz?: number;
      /** how many of each channel; as many as there is room for if it is not given */
      samples?: number;
      /** name or number of the axis parameter that is waited for; none: it begins at once */
      trigger_parameter?: string;
      /** rising: it becomes greater than the value; falling: it no longer is; or both */
      trigger_edge?: string;
      /** as the module counts it */
      trigger_value?: number;
      /** how much of the recording lies before the trigger */
      pretrigger_percent?: number;
      /** goes on with what the module records already, or has recorded, if that is this */
      resume?: boolean;
    };
    result: {
      /** its number, for the other methods */
      capture: number;
      /** what is recorded, in the order of the values */
      channels: {
        /** standard name; null if the number has none */
        parameter: string | null;
        /** number of the axis parameter */
        number: number;
        /** what its values count; null if that has no name */
        unit: string | null;
      }[];
      /** how many of each channel */
      samples: number;
      /** how many of them lie before the trigger */
      pretrigger: number;
      /** how many a second */
      rate_hz: number;
    };
  };
  /** how far a capture has come */
  "capture.state": {
    params: {
      /** name of the axis */
      axis: string;
      /** which capture: the number that capture.start gave */
      capture: number;
    };
    result: {
      /** idle, pretrigger, trigger, capture, complete or error */
      state: string;
    };
  };
  /** reads what a module has recorded */
  "capture.read": {
    params: {
      /** name of the axis */
      axis: string;
      /** which capture: the number that capture.start gave */
      capture: number;
      /** index of the first value, of all channels together */
      first: number;
      /** how many */
      count: number;
    };
    result: {
      /** one of each channel after the other */
      values: number[];
    };
  };
  /** the module records nothing any more, and forgets what it has */
  "capture.end": {
    params: {
      /** name of the axis */
      axis: string;
      /** only this one; nothing happens to another one that was begun since */
      capture?: number;
    };
    result: Record<string, never>;
  };
  /** where the axis is and what it does */
  "axis.get_state": {
    params: {
      /** name of the axis */
      axis: string;
      /** so old it may be; the module is asked if absent */
      max_age_ms?: number;
    };
    result: {
      /** name of the axis */
      axis: string;
      /** where it is */
      position_microsteps: number;
      /** speed in the module's own unit */
      velocity_internal: number;
      /** speed in microsteps per second; null if unknown */
      velocity_pps: number | null;
      /** where it is to go */
      target_microsteps: number;
      /** position equals target, perhaps only in passing */
      position_reached: boolean;
      /** its speed is not zero, or it turns round to come to its target from one side */
      moving: boolean;
      /** what the next three are in; null if the axis has none */
      unit: string | null;
      /** where it is */
      position: number | null;
      /** speed per second */
      velocity: number | null;
      /** where it is to go */
      target: number | null;
      /** its module has started again, or is another one: nothing moves it until axis.recover or axis.home */
      latched: boolean;
      /** it has searched its reference, or was told where it is, while tmcld was there, and its module has not started again since */
      referenced: boolean;
      /** why it stands short of its target: stall, deviation, left_limit, right_limit, deadman, supply, client, lease_lost, search_limit, daemon, velocity_mode (something else than tmcld has stopped it) or unknown; null while it moves or where that is not known */
      stop_cause: string | null;
      /** how old the oldest of these values is */
      age_ms: number;
      /** number of its lease; null if it has none */
      lease: number | null;
      /** it turns, and does not stop when a connection ends */
      unattended: boolean;
      /** the client that it turns for, or that has its lease; null if there is none */
      owner: string | null;
      /** what a line, a path or a Mint program has changed, as it was before: set back as soon as its module takes it */
      unrestored: {
        /** standard name of the axis parameter */
        parameter: string;
        /** its number */
        number: number;
        /** what it is set to */
        value: number;
      }[];
      /** what is wrong with its driver or its supply, as axis.get_errors names it */
      faults: string[];
      /** grows whenever a client, or tmcld itself, has it stopped: also where it stands */
      last_stop: number;
    };
  };
  /** what its module says is wrong, in words */
  "axis.get_errors": {
    params: {
      /** name of the axis */
      axis: string;
    };
    result: {
      /** name of the axis */
      axis: string;
      /** what its module says is wrong: stall, deviation, overtemperature, overtemperature_warning, short_to_ground_a, short_to_ground_b, open_load_a, open_load_b, undervoltage, overvoltage, i2t_exceeded */
      flags: string[];
      /** open_load_a, open_load_b: reported, but not yet twice in a row while the axis turned slowly */
      unproven: string[];
      /** those that are closed: left, right, home */
      switches: string[];
      /** as in axis.get_state */
      stop_cause: string | null;
      /** voltage of the supply; null if it tells none */
      supply_volts: number | null;
      /** temperature of the module; null if it tells none */
      temperature_celsius: number | null;
    };
  };
  /** what the axis counts in */
  "axis.get_units": {
    params: {
      /** name of the axis */
      axis: string;
    };
    result: {
      /** name of the axis */
      axis: string;
      /** model of its module; null if it is not known */
      model: string | null;
      /** what positions are measured in; null if nothing is set */
      unit: string | null;
      /** how many of these a turn of the motor is */
      units_per_revolution: number | null;
      /** how many of these a turn of what its gear drives is */
      units_per_output_revolution: number | null;
      /** turns of the motor for one of those */
      gear_ratio: number | null;
      /** they grow in the motor's negative direction */
      reverse: boolean | null;
      /** null where the module tells none */
      microsteps_per_revolution: number | null;
      /** full steps of a turn */
      full_steps: number | null;
      /** what the module's unit of velocity is, in microsteps per second */
      velocity_unit_pps: number | null;
      /** what its unit of acceleration is, in microsteps per second squared */
      acceleration_unit_pps2: number | null;
      /** least position that moves may end at, in the unit; null without soft limits */
      soft_limit_minimum: number | null;
      /** the greatest */
      soft_limit_maximum: number | null;
      /** the least one in microsteps; also without a unit */
      soft_limit_minimum_microsteps: number | null;
      /** the greatest */
      soft_limit_maximum_microsteps: number | null;
      /** what encoder positions count in; null where that is microsteps */
      encoder_counts_per_unit: number | null;
    };
  };
  /** reads an axis parameter */
  "parameter.get": {
    params: {
      /** name of the axis */
      axis: string;
      /** standard name or number of the axis parameter */
      parameter: string | number;
      /** refused instead of sent when it could not be sent so soon after it came in */
      deadline_ms?: number;
    };
    result: {
      /** standard name; null if the number has none */
      parameter: string | null;
      /** number of the axis parameter */
      number: number;
      /** its value */
      value: number;
      /** what the next one is in, such as mm/s; null if there is none */
      unit: string | null;
      /** its value in the axis' unit */
      value_in_unit: number | null;
    };
  };
  /** sets an axis parameter */
  "parameter.set": {
    params: {
      /** name of the axis */
      axis: string;
      /** standard name or number of the axis parameter */
      parameter: string | number;
      /** refused instead of sent when it could not be sent so soon after it came in */
      deadline_ms?: number;
      /** what to set it to */
      value?: number;
      /** the same, instead; a number: in the axis' unit */
      value_in_unit?: number | string;
    };
    result: {
      /** standard name; null if the number has none */
      parameter: string | null;
      /** number of the axis parameter */
      number: number;
      /** its value */
      value: number;
      /** what the next one is in, such as mm/s; null if there is none */
      unit: string | null;
      /** its value in the axis' unit */
      value_in_unit: number | null;
      /** warnings about moves with its settings */
      warnings: string[];
    };
  };
  /** copies an axis parameter to the EEPROM */
  "parameter.store": {
    params: {
      /** name of the axis */
      axis: string;
      /** standard name or number of the axis parameter */
      parameter: string | number;
      /** refused instead of sent when it could not be sent so soon after it came in */
      deadline_ms?: number;
    };
    result: {
      /** standard name; null if the number has none */
      parameter: string | null;
      /** number of the axis parameter */
      number: number;
    };
  };
  /** copies an axis parameter back from the EEPROM */
  "parameter.restore": {
    params: {
      /** name of the axis */
      axis: string;
      /** standard name or number of the axis parameter */
      parameter: string | number;
      /** refused instead of sent when it could not be sent so soon after it came in */
      deadline_ms?: number;
    };
    result: {
      /** standard name; null if the number has none */
      parameter: string | null;
      /** number of the axis parameter */
      number: number;
    };
  };
  /** the parameters that the model of an axis has */
  "parameter.list": {
    params: {
      /** name of the axis */
      axis: string;
    };
    result: {
      /** ascending; none for a model that is not known */
      parameters: {
        /** its number */
        number: number;
        /** its standard name */
        name: string;
        /** read or read_write */
        access: string;
        /** can be kept in the EEPROM */
        stored: boolean;
        /** least value */
        minimum: number;
        /** greatest value */
        maximum: number;
        /** factory default */
        initial: number;
        /** what the module counts in */
        unit: string;
        /** what it is */
        meaning: string;
        /** what value_in_unit is in */
        axis_unit: string | null;
        /** other names that are understood */
        aliases: string[];
      }[];
    };
  };
  /** reads all settings of a module */
  "settings.read": {
    params: {
      /** name of the bus */
      bus: string;
      /** address of the module */
      address: number;
    };
    result: {
      /** model of the module */
      model: string;
      /** its version */
      firmware: string;
      /** in the order of their numbers */
      settings: {
        /** where it stands in a file: global, interrupts, motor.0 */
        section: string;
        /** its standard name */
        parameter: string;
        /** its number */
        number: number;
        /** its value */
        value: number;
        /** what a new module has */
        initial: number;
        /** unit of the value; null for codes and flags */
        unit: string | null;
        /** what it does */
        meaning: string;
      }[];
      /** what is of this module alone, such as its address, and is never loaded */
      apart: {
        /** where it stands in a file: global, interrupts, motor.0 */
        section: string;
        /** its standard name */
        parameter: string;
        /** its number */
        number: number;
        /** its value */
        value: number;
        /** what a new module has */
        initial: number;
        /** unit of the value; null for codes and flags */
        unit: string | null;
        /** what it does */
        meaning: string;
      }[];
      /** the same as a file */
      toml: string;
    };
  };
  /** compares a module with a file of settings, or with the one that is configured */
  "settings.compare": {
    params: {
      /** name of the bus */
      bus: string;
      /** address of the module */
      address: number;
      /** the file, as settings.read gives it; the configured one if absent */
      toml?: string;
    };
    result: {
      /** model of the module */
      model: string;
      /** what settings.load would write */
      differences: {
        /** where it stands in a file: global, interrupts, motor.0 */
        section: string;
        /** its standard name */
        parameter: string;
        /** its number */
        number: number;
        /** what the module has; null: it has none */
        present: number | null;
        /** what the file says */
        wanted: number;
      }[];
    };
  };
  /** sets a module as a file of settings says; its motors must stand, and nothing moves */
  "settings.load": {
    params: {
      /** name of the bus */
      bus: string;
      /** address of the module */
      address: number;
      /** the file, as settings.read gives it; settings may be left out */
      toml: string;
      /** keeps those of the file in the module's EEPROM, too */
      store?: boolean;
    };
    result: {
      /** what was written; 'present' is what was before */
      written: {
        /** where it stands in a file: global, interrupts, motor.0 */
        section: string;
        /** its standard name */
        parameter: string;
        /** its number */
        number: number;
        /** what the module has; null: it has none */
        present: number | null;
        /** what the file says */
        wanted: number;
      }[];
      /** what could not be written, or not be stored */
      refused: {
        /** where it stands in a file: global, interrupts, motor.0 */
        section: string;
        /** its standard name */
        parameter: string;
        /** its number */
        number: number;
        /** what the module or the configuration says to it */
        why: string;
      }[];
      /** what is not as in the file afterwards */
      differing: {
        /** where it stands in a file: global, interrupts, motor.0 */
        section: string;
        /** its standard name */
        parameter: string;
        /** its number */
        number: number;
        /** what the module has; null: it has none */
        present: number | null;
        /** what the file says */
        wanted: number;
      }[];
      /** how many were copied to the EEPROM */
      stored: number;
    };
  };
  /** keeps all settings of an axis as they are now, in the module's EEPROM */
  "settings.store": {
    params: {
      /** name of the axis */
      axis: string;
    };
    result: {
      /** name of the axis */
      axis: string;
      /** how many were copied to the EEPROM */
      stored: number;
      /** what could not be stored */
      refused: {
        /** where it stands in a file: global, interrupts, motor.0 */
        section: string;
        /** its standard name */
        parameter: string;
        /** its number */
        number: number;
        /** what the module or the configuration says to it */
        why: string;
      }[];
    };
  };
  /** reads a coordinate */
  "coordinate.get": {
    params: {
      /** name of the axis */
      axis: string;
      /** number of the coordinate */
      number: number;
      /** refused instead of sent when it could not be sent so soon after it came in */
      deadline_ms?: number;
    };
    result: {
      /** where it is */
      position_microsteps: number;
      /** what it measures in; null if the axis has no unit */
      unit: string | null;
      /** where it is, in the unit */
      position: number | null;
    };
  };
  /** remembers a position by a number */
  "coordinate.set": {
    params: {
      /** name of the axis */
      axis: string;
      /** number of the coordinate */
      number: number;
      /** refused instead of sent when it could not be sent so soon after it came in */
      deadline_ms?: number;
      /** what to remember */
      position_microsteps?: number;
      /** the same, instead; a number: in the axis' unit */
      position?: number | string;
    };
    result: Record<string, never>;
  };
  /** remembers where the axis is */
  "coordinate.capture": {
    params: {
      /** name of the axis */
      axis: string;
      /** number of the coordinate */
      number: number;
      /** refused instead of sent when it could not be sent so soon after it came in */
      deadline_ms?: number;
    };
    result: {
      /** where it is */
      position_microsteps: number;
      /** what it measures in; null if the axis has no unit */
      unit: string | null;
      /** where it is, in the unit */
      position: number | null;
    };
  };
  /** starts a move to a coordinate */
  "coordinate.move": {
    params: {
      /** name of the axis */
      axis: string;
      /** number of the coordinate */
      number: number;
      /** refused instead of sent when it could not be sent so soon after it came in */
      deadline_ms?: number;
    };
    result: Record<string, never>;
  };
  /** starts motors of a module together, each to its own coordinate of this number */
  "coordinate.start": {
    params: {
      /** name of the bus */
      bus: string;
      /** address of the module */
      address: number;
      /** refused instead of sent when it could not be sent so soon after it came in */
      deadline_ms?: number;
      /** number of the coordinate */
      number: number;
      /** which motors */
      motors: number[];
      /** scale their velocities so that they arrive together; false if absent */
      interpolated?: boolean;
    };
    result: Record<string, never>;
  };
  /** copies coordinates of all motors of the axis' module to the EEPROM */
  "coordinate.store": {
    params: {
      /** name of the axis */
      axis: string;
      /** number of the coordinate; all if absent */
      number?: number;
      /** refused instead of sent when it could not be sent so soon after it came in */
      deadline_ms?: number;
    };
    result: Record<string, never>;
  };
  /** copies them back from the EEPROM */
  "coordinate.load": {
    params: {
      /** name of the axis */
      axis: string;
      /** number of the coordinate; all if absent */
      number?: number;
      /** refused instead of sent when it could not be sent so soon after it came in */
      deadline_ms?: number;
    };
    result: Record<string, never>;
  };
  /** reads a global parameter */
  "global.get": {
    params: {
      /** name of the bus */
      bus: string;
      /** address of the module */
      address: number;
      /** refused instead of sent when it could not be sent so soon after it came in */
      deadline_ms?: number;
      /** standard name or number of the global parameter */
      parameter: string | number;
      /** bank of the parameter; 0 if absent */
      bank?: number;
    };
    result: {
      /** standard name; null if it was given by number */
      parameter: string | null;
      /** number of the global parameter */
      number: number;
      /** its bank */
      bank: number;
      /** its value */
      value: number;
    };
  };
  /** sets a global parameter */
  "global.set": {
    params: {
      /** name of the bus */
      bus: string;
      /** address of the module */
      address: number;
      /** refused instead of sent when it could not be sent so soon after it came in */
      deadline_ms?: number;
      /** standard name or number of the global parameter */
      parameter: string | number;
      /** bank of the parameter; 0 if absent */
      bank?: number;
      /** what to set it to */
      value: number;
    };
    result: {
      /** standard name; null if it was given by number */
      parameter: string | null;
      /** number of the global parameter */
      number: number;
      /** its bank */
      bank: number;
      /** its value */
      value: number;
    };
  };
  /** copies a global parameter to the EEPROM */
  "global.store": {
    params: {
      /** name of the bus */
      bus: string;
      /** address of the module */
      address: number;
      /** refused instead of sent when it could not be sent so soon after it came in */
      deadline_ms?: number;
      /** standard name or number of the global parameter */
      parameter: string | number;
      /** bank of the parameter; 0 if absent */
      bank?: number;
    };
    result: {
      /** standard name; null if it was given by number */
      parameter: string | null;
      /** number of the global parameter */
      number: number;
      /** its bank */
      bank: number;
    };
  };
  /** copies a global parameter back from the EEPROM */
  "global.restore": {
    params: {
      /** name of the bus */
      bus: string;
      /** address of the module */
      address: number;
      /** refused instead of sent when it could not be sent so soon after it came in */
      deadline_ms?: number;
      /** standard name or number of the global parameter */
      parameter: string | number;
      /** bank of the parameter; 0 if absent */
      bank?: number;
    };
    result: {
      /** standard name; null if it was given by number */
      parameter: string | null;
      /** number of the global parameter */
      number: number;
      /** its bank */
      bank: number;
    };
  };
  /** reads an input or output */
  "io.get": {
    params: {
      /** name of the bus */
      bus: string;
      /** address of the module */
      address: number;
      /** refused instead of sent when it could not be sent so soon after it came in */
      deadline_ms?: number;
      /** number of the port */
      port: number;
      /** 0 digital inputs, 1 analog inputs, 2 digital outputs; 0 if absent */
      bank?: number;
    };
    result: {
      /** value of the port */
      value: number;
    };
  };
  /** sets a digital output */
  "io.set": {
    params: {
      /** name of the bus */
      bus: string;
      /** address of the module */
      address: number;
      /** refused instead of sent when it could not be sent so soon after it came in */
      deadline_ms?: number;
      /** number of the port */
      port: number;
      /** what to set it to */
      value: number;
    };
    result: {
      /** value of the port */
      value: number;
    };
  };
  /** what a module's firmware says of itself */
  "module.info": {
    params: {
      /** name of the bus */
      bus: string;
      /** address of the module */
      address: number;
      /** refused instead of sent when it could not be sent so soon after it came in */
      deadline_ms?: number;
    };
    result: {
      /** what the firmware is for */
      module_id: number | null;
      /** its version */
      version: number | null;
      /** 1 bootloader, 2 stand-alone programs, 4 CANopen, 8 EtherCAT, 16 IO-Link */
      capabilities: number | null;
      /** kind of release */
      release_type: number | null;
      /** what the bootloader is for */
      bootloader_id: number | null;
      /** its version */
      bootloader_version: number | null;
      /** bits of an axis parameter's number */
      axis_parameter_width: number | null;
      /** bits of a register's address */
      register_address_width: number | null;
      /** what it was built from */
      git_hash: number | null;
    };
  };
  /** lets a module tell when motors arrive: events of the kind target_reached */
  "module.report_arrivals": {
    params: {
      /** name of the bus */
      bus: string;
      /** address of the module */
      address: number;
      /** refused instead of sent when it could not be sent so soon after it came in */
      deadline_ms?: number;
      /** which motors; none of them if empty */
      motors: number[];
      /** every move from now on; only the next one if absent */
      every?: boolean;
    };
    result: Record<string, never>;
  };
  /** restarts a module */
  "module.reset": {
    params: {
      /** name of the bus */
      bus: string;
      /** address of the module */
      address: number;
      /** refused instead of sent when it could not be sent so soon after it came in */
      deadline_ms?: number;
    };
    result: Record<string, never>;
  };
  /** restores everything in a module to how it was delivered */
  "module.factory_reset": {
    params: {
      /** name of the bus */
      bus: string;
      /** address of the module */
      address: number;
      /** refused instead of sent when it could not be sent so soon after it came in */
      deadline_ms?: number;
    };
    result: Record<string, never>;
  };
  /** makes a program file of a program's text; asks no module */
  "program.assemble": {
    params: {
      /** the text, which includes no file but TMCLParam.tmc */
      text: string;
      /** whose parameters TMCLParam.tmc names, such as TMCM-1110; those that have one number on all models if absent */
      model?: string;
    };
    result: {
      /** a program file, in hexadecimal */
      program: string;
      /** how many commands it has */
      commands: number;
      /** of each command, the line of the text, from 1 */
      lines: number[];
      /** in their order in the text */
      labels: {
        /** as it is written where it stands */
        name: string;
        /** of the command behind it */
        address: number;
      }[];
    };
  };
  /** loads a program into a module; tells its progress by notify_progress */
  "program.load": {
    params: {
      /** name of the bus */
      bus: string;
      /** address of the module */
      address: number;
      /** a program file, in hexadecimal */
      program: string;
      /** address of its first command; 0 if absent */
      first_address?: number;
      /** read it back and compare; true if absent */
      compare?: boolean;
    };
    result: {
      /** how many commands it has */
      commands: number;
    };
  };
  /** compares a program with the one in a module */
  "program.compare": {
    params: {
      /** name of the bus */
      bus: string;
      /** address of the module */
      address: number;
      /** a program file, in hexadecimal */
      program: string;
      /** address of its first command; 0 if absent */
      first_address?: number;
    };
    result: {
      /** how many commands it has */
      commands: number;
    };
  };
  /** reads the program in a module */
  "program.read": {
    params: {
      /** name of the bus */
      bus: string;
      /** address of the module */
      address: number;
      /** address of its first command; 0 if absent */
      first_address?: number;
      /** how many commands; up to its end if absent */
      length?: number;
    };
    result: {
      /** how many commands it has */
      commands: number;
      /** a program file, in hexadecimal */
      program: string;
    };
  };
  /** runs the program in a module */
  "program.run": {
    params: {
      /** name of the bus */
      bus: string;
      /** address of the module */
      address: number;
      /** refused instead of sent when it could not be sent so soon after it came in */
      deadline_ms?: number;
      /** where it begins; where it stands if absent */
      first_address?: number;
    };
    result: {
      /** true: what the program sets turning has no owner, and turns on when a connection ends */
      unattended: boolean;
    };
  };
  /** ends the program; motors go on */
  "program.stop": {
    params: {
      /** name of the bus */
      bus: string;
      /** address of the module */
      address: number;
      /** refused instead of sent when it could not be sent so soon after it came in */
      deadline_ms?: number;
    };
    result: Record<string, never>;
  };
  /** executes one command of the program */
  "program.step": {
    params: {
      /** name of the bus */
      bus: string;
      /** address of the module */
      address: number;
      /** refused instead of sent when it could not be sent so soon after it came in */
      deadline_ms?: number;
    };
    result: {
      /** true: what the program sets turning has no owner, and turns on when a connection ends */
      unattended: boolean;
    };
  };
  /** executes commands of the program one by one, until it stands before one of these; tells its progress by notify_progress */
  "program.step_to": {
    params: {
      /** name of the bus */
      bus: string;
      /** address of the module */
      address: number;
      /** addresses in the program: it ends before a command there, but executes the first one anyhow */
      until?: number[];
      /** how many commands at most; 1 if absent, or 1000 with `until` */
      most_steps?: number;
      /** how long one command may take, such as WAIT; 60000 if absent */
      wait_ms?: number;
    };
    result: {
      /** address: the next command is at one of them; ended: the program has ended, failed or was stopped; steps: so many were executed; waits: the command is not over yet */
      reason: string;
      /** how many commands were executed, one that waits included */
      steps: number;
      /** stopped, running, stepping or reset */
      state: string;
      /** the next command */
      next_address: number | null;
      /** 0: none; null if the module does not say */
      last_error: number | null;
      /** true: what the program sets turning has no owner, and turns on when a connection ends */
      unattended: boolean;
    };
  };
  /** ends the program and sets it back to its start */
  "program.reset": {
    params: {
      /** name of the bus */
      bus: string;
      /** address of the module */
      address: number;
      /** refused instead of sent when it could not be sent so soon after it came in */
      deadline_ms?: number;
    };
    result: Record<string, never>;
  };
  /** what the program does */
  "program.status": {
    params: {
      /** name of the bus */
      bus: string;
      /** address of the module */
      address: number;
      /** refused instead of sent when it could not be sent so soon after it came in */
      deadline_ms?: number;
    };
    result: {
      /** stopped, running, stepping or reset */
      state: string;
      /** the next command; null if the module does not say */
      next_address: number | null;
      /** 0: none; null if the module does not say */
      last_error: number | null;
    };
  };
  /** stops the program there from now on */
  "program.set_breakpoint": {
    params: {
      /** name of the bus */
      bus: string;
      /** address of the module */
      address: number;
      /** refused instead of sent when it could not be sent so soon after it came in */
      deadline_ms?: number;
      /** address in the program */
      at: number;
    };
    result: Record<string, never>;
  };
  /** does not stop it there any more */
  "program.clear_breakpoint": {
    params: {
      /** name of the bus */
      bus: string;
      /** address of the module */
      address: number;
      /** refused instead of sent when it could not be sent so soon after it came in */
      deadline_ms?: number;
      /** address in the program */
      at: number;
    };
    result: Record<string, never>;
  };
  /** does not stop it anywhere any more */
  "program.clear_breakpoints": {
    params: {
      /** name of the bus */
      bus: string;
      /** address of the module */
      address: number;
      /** refused instead of sent when it could not be sent so soon after it came in */
      deadline_ms?: number;
    };
    result: Record<string, never>;
  };
  /** what runs in a module, as its updates need to know */
  "firmware.status": {
    params: {
      /** name of the bus */
      bus: string;
      /** address of the module */
      address: number;
      /** refused instead of sent when it could not be sent so soon after it came in */
      deadline_ms?: number;
    };
    result: {
      /** model of the module; null if it has no name */
      model: string | null;
      /** its number */
      model_number: number;
      /** what answers: 1110V142, or 1110B101 for its bootloader */
      running: string;
      /** no firmware runs */
      in_bootloader: boolean;
    };
  };
  /** hands over the next part of a firmware image */
  "firmware.stage": {
    params: {
      /** how many bytes were handed over before; 0: a new image */
      offset: number;
      /** the next bytes, in hexadecimal */
      data: string;
    };
    result: {
      /** how many there are now */
      bytes: number;
    };
  };
  /** exchanges the firmware of a module for the image that was handed over; tells its progress by notify_progress */
  "firmware.upload": {
    params: {
      /** name of the bus */
      bus: string;
      /** address of the module */
      address: number;
      /** address of the image's first byte */
      start: number;
      /** how many bytes were handed over */
      bytes: number;
      /** also an image that does not say that it is for this model */
      force?: boolean;
    };
    result: {
      /** model of the module; null if it has no name */
      model: string | null;
      /** its number */
      model_number: number;
      /** what ran before: 1110V101 */
      before: string;
      /** what runs now */
      running: string;
      /** of the image */
      checksum: number;
    };
  };
  /** stops all axes at once */
  "system.stop_all": {
    params: Record<string, never>;
    result: {
      /** those that confirmed */
      stopped: {
        /** name of the axis */
        axis: string;
        /** passed until its module had confirmed */
        milliseconds: number;
      }[];
      /** those that did not */
      failed: {
        /** name of the axis */
        axis: string;
        /** what went wrong */
        error: Record<string, unknown>;
      }[];
    };
  };
  /** tells of states by notify_state whenever they change, and of events */
  "subscribe": {
    params: {
      /** names of the axes; all of them if absent */
      axes?: string[];
      /** least time between two states; 50 if absent */
      interval_ms?: number;
      /** names or numbers of axis parameters that are read as well, 8 at most */
      parameters?: string[];
      /** tells of each look at an axis, whether anything has changed or not */
      every_look?: boolean;
    };
    result: {
      /** what unsubscribe takes */
      subscription: number;
      /** the state of each axis now */
      states: {
        /** name of the axis */
        axis: string;
        /** where it is */
        position_microsteps: number;
        /** speed in the module's own unit */
        velocity_internal: number;
        /** speed in microsteps per second; null if unknown */
        velocity_pps: number | null;
        /** where it is to go */
        target_microsteps: number;
        /** position equals target, perhaps only in passing */
        position_reached: boolean;
        /** its speed is not zero, or it turns round to come to its target from one side */
        moving: boolean;
        /** what the next three are in; null if the axis has none */
        unit: string | null;
        /** where it is */
        position: number | null;
        /** speed per second */
        velocity: number | null;
        /** where it is to go */
        target: number | null;
        /** its module has started again, or is another one: nothing moves it until axis.recover or axis.home */
        latched: boolean;
        /** it has searched its reference, or was told where it is, while tmcld was there, and its module has not started again since */
        referenced: boolean;
        /** why it stands short of its target: stall, deviation, left_limit, right_limit, deadman, supply, client, lease_lost, search_limit, daemon, velocity_mode (something else than tmcld has stopped it) or unknown; null while it moves or where that is not known */
        stop_cause: string | null;
        /** how old the oldest of these values is */
        age_ms: number;
        /** number of its lease; null if it has none */
        lease: number | null;
        /** it turns, and does not stop when a connection ends */
        unattended: boolean;
        /** the client that it turns for, or that has its lease; null if there is none */
        owner: string | null;
        /** what a line, a path or a Mint program has changed, as it was before: set back as soon as its module takes it */
        unrestored: {
          /** standard name of the axis parameter */
          parameter: string;
          /** its number */
          number: number;
          /** what it is set to */
          value: number;
        }[];
        /** what is wrong with its driver or its supply, as axis.get_errors names it */
        faults: string[];
        /** grows whenever a client, or tmcld itself, has it stopped: also where it stands */
        last_stop: number;
        /** counts the states of the axis */
        seq: number;
        /** when it was read, on the daemon's monotonic clock */
        event_time_ms: number;
        /** the parameters that the subscription names, as they were read last */
        samples: {
          /** standard name; null if the number has none */
          parameter: string | null;
          /** number of the axis parameter */
          number: number;
          /** its value */
          value: number;
          /** what the next one is in, such as mm/s; null if there is none */
          unit: string | null;
          /** its value in the axis' unit */
          value_in_unit: number | null;
          /** how old the value is */
          age_ms: number;
        }[];
      }[];
      /** those that do not answer now */
      failed: {
        /** name of the axis */
        axis: string;
        /** what went wrong */
        error: Record<string, unknown>;
      }[];
    };
  };
  /** ends a subscription */
  "unsubscribe": {
    params: {
      /** what subscribe gave */
      subscription: number;
    };
    result: Record<string, never>;
  };
}

/** What a client needs to be for a method. */
export const roleFor: Record<keyof Methods, Role> = {
  "rpc.discover": "observe",
  "bus.list": "observe",
  "bus.trace": "observe",
  "bus.scan": "observe",
  "doctor.examine": "observe",
  "module.list": "observe",
  "module.execute": "stop",
  "axis.list": "observe",
  "axis.move_to": "operate",
  "axis.move_by": "operate",
  "axis.rotate": "operate",
  "axis.jog": "operate",
  "axis.resonance": "operate",
  "axis.stop": "stop",
  "axis.wait": "observe",
  "lease.acquire": "operate",
  "lease.renew": "operate",
  "lease.release": "stop",
  "lease.list": "observe",
  "lease.break": "configure",
  "token.add": "configure",
  "token.list": "configure",
  "token.invite": "configure",
  "token.revoke": "configure",
  "client.list": "configure",
  "audit.tail": "configure",
  "page.find": "observe",
  "configuration.get": "configure",
  "configuration.set": "configure",
  "speak_for": "stop",
  "line.move": "operate",
  "path.stage": "operate",
  "path.plan": "operate",
  "path.run": "operate",
  "path.pause": "operate",
  "path.resume": "operate",
  "path.status": "observe",
  "path.feed": "operate",
  "path.stop": "stop",
  "mint.run": "operate",
  "axis.get_ramp": "observe",
  "axis.plan_ramp": "observe",
  "axis.set_ramp": "operate",
  "ramp.compare": "observe",
  "ramp.find": "observe",
  "profile.simulate": "observe",
  "profile.solve": "observe",
  "axis.home": "operate",
  "axis.start_home": "operate",
  "axis.stop_home": "stop",
  "axis.recover": "operate",
  "axis.set_deadman": "configure",
  "axis.test_deadman": "configure",
  "axis.tune": "configure",
  "axis.verify": "configure",
  "capture.start": "operate",
  "capture.state": "observe",
  "capture.read": "observe",
  "capture.end": "operate",
  "axis.get_state": "observe",
  "axis.get_errors": "observe",
  "axis.get_units": "observe",
  "parameter.get": "observe",
  "parameter.set": "operate",
  "parameter.store": "configure",
  "parameter.restore": "configure",
  "parameter.list": "observe",
  "settings.read": "observe",
  "settings.compare": "observe",
  "settings.load": "configure",
  "settings.store": "configure",
  "coordinate.get": "observe",
  "coordinate.set": "configure",
  "coordinate.capture": "configure",
  "coordinate.move": "operate",
  "coordinate.start": "operate",
  "coordinate.store": "configure",
  "coordinate.load": "configure",
  "global.get": "observe",
  "global.set": "configure",
  "global.store": "configure",
  "global.restore": "configure",
  "io.get": "observe",
  "io.set": "operate",
  "module.info": "observe",
  "module.report_arrivals": "operate",
  "module.reset": "configure",
  "module.factory_reset": "configure",
  "program.assemble": "observe",
  "program.load": "configure",
  "program.compare": "observe",
  "program.read": "observe",
  "program.run": "operate",
  "program.stop": "operate",
  "program.step": "operate",
  "program.step_to": "operate",
  "program.reset": "operate",
  "program.status": "observe",
  "program.set_breakpoint": "configure",
  "program.clear_breakpoint": "configure",
  "program.clear_breakpoints": "configure",
  "firmware.status": "observe",
  "firmware.stage": "configure",
  "firmware.upload": "configure",
  "system.stop_all": "stop",
  "subscribe": "observe",
  "unsubscribe": "observe",
};
