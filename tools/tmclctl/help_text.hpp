/// What --help says besides the lists of options.
#pragma once

namespace tmclctl::help_text {

constexpr const char* description =
    "Moves and inspects the axes of TMCM modules, through a running tmcld or straight on a bus.";

constexpr const char* footer = R"(
An AXIS is a name from tmcld's configuration, or the module's address and the motor's number, such as
1/0, or bench:1/0 where there are several buses. With --direct, names come from --config FILE.
A PARAM is a number or a standard name, such as max_velocity: 'tmclctl params AXIS' lists them.
A position, distance, velocity or acceleration has a unit behind its number: 51200microsteps, 1.5rev,
2rps, 120rpm, 61035pps, 100000pps/s, and, if tmcld's configuration gives the axis a unit such as mm:
10mm, 100um, 1in, 5mm/s, 50mm/s^2 (or 50mm/s2). On an axis without such a unit a bare number is what
the module counts in: microsteps; for velocities see 'tmclctl params AXIS'. On an axis with one, a
bare number other than 0 is refused, unless --internal says that it is what the module counts. The
VALUE of 'set' is always that if it is bare. With --direct, turns are counted by the module's
microsteps (parameter 140) and --full-steps. What is told of an axis with a unit is in that unit; with
--internal it is what the module counts.

Examples:
  tmclctl scan                                   which modules are there?
  tmclctl axes                                   which axes does tmcld know?
  tmclctl move x 51200 --wait                    go to 51200 and wait until it stands there
  tmclctl move x -1000 --by                      go back by 1000
  tmclctl rotate x -500                          turn left until Ctrl-C
  tmclctl stop x                                 stop
  tmclctl stop --all                             stop everything
  tmclctl set x max_velocity 1500                until the module loses power ...
  tmclctl store x max_velocity                   ... or for good
  tmclctl home x                                 search the reference position
  tmclctl plot x --by 51200 --svg move.svg       move and draw how it went
  tmclctl --direct serial:/dev/ttyACM0@115200 get 1/0 actual_position
  tmclctl --direct can:can0 --config tmcld.toml move x 12.5mm --wait
  tmclctl --url https://gateway.example:4143 --token-file lab.token stop --all
  tmclctl --json state x                         for scripts: one JSON document
  tmclctl profile simulate --help                how would a chip move?
  tmclctl program upload loop.tmc 1 --run        programs that modules run by themselves

Exit codes:
    0  done
    1  the module or tmcld refused, and nothing changed; or the output cannot be written
    2  the command line asks for something that does not exist or is out of range, or a file that it
       names is wrong; nothing was sent
    3  not sent: no connection, no answer from the module lately; or a reading without an answer;
       nothing changed
    4  outcome unknown: sent, but no answer; it may have been executed
    5  the wait ended early: the move was interrupted, or --timeout passed
  130  Ctrl-C while waiting: the axis goes on moving (143 for SIGTERM)
With --json an error is a JSON document on standard output, too:
  {"error": {"name": ..., "message": ..., "hint": ..., "outcome": ..., "exit_code": ...}}

Environment:
  TMCLD_SOCKET  the daemon's socket, if --socket is not given (otherwise /run/tmcld/tmcld.sock)
  NO_COLOR      no colours, if set
)";

constexpr const char* help = R"(
  tmclctl help move
  tmclctl help program upload
)";

constexpr const char* scan = R"(
Asks every address who is there: through tmcld on all its buses, with --direct on that one.
One row for each module that answers; exit code 3 if none does. Takes some seconds on a slow serial
line. NO FIRMWARE marks a module whose bootloader answers, as after an upload that was cut short.

  tmclctl scan
  tmclctl --direct can:can0 scan --addresses 1-20
  tmclctl --direct tcp:10.0.0.7:4001 --reply-timeout 1000 scan     far away, so answers take long
)";

constexpr const char* modules = R"(
Those of the axes in tmcld's configuration, and how they are: ready, silent (they do not answer), or
unknown (their bus is not open, or they were not asked yet). With --direct it is a scan.

  tmclctl modules
  tmclctl --json modules
)";

constexpr const char* axes = R"(
The axes of tmcld's configuration; with --direct those of all modules that a scan finds. Where the state
is unknown because a bus is not open, it says why. Of an axis with a unit it says how many microsteps,
and counts of its encoder, a unit is.

  tmclctl axes
  tmclctl --direct can:can0 axes
)";

constexpr const char* ports = R"(
Looks at what the kernel lists, and opens nothing. LINK is what --direct and the
configuration of tmcld take; 'usb:' with the USB port leads there as well, past the
serial port. Programs of other users cannot be seen holding a port unless they lock it.

  tmclctl ports
  tmclctl --direct auto scan                     the only module by USB that there is
)";

constexpr const char* models = R"(
Needs no module. 'tmclctl params --model MODEL' lists what one of them can be told. With --json,
"document" is the manual that its ranges follow, or says that there is none.

  tmclctl models
  tmclctl params --model TMCM-1110
)";

constexpr const char* state = R"(
Of an axis with a unit it also says how many microsteps, and counts of its encoder, a unit is.

  tmclctl state x
  tmclctl --json state x                         with every value in both units
)";

constexpr const char* store = R"(
Keeps the value that the parameter has now: the module starts with it from then on. Only some
parameters can be stored: 'tmclctl params AXIS' shows RWE in its column ACCESS.

  tmclctl set x max_velocity 1500
  tmclctl store x max_velocity
)";

constexpr const char* restore = R"(
Sets the parameter to the value that was stored last, as the next start of the module would.

  tmclctl restore x max_velocity
)";

constexpr const char* params = R"(
An axis has the parameters of its module's model; without a module, --model lists those of any.
ACCESS is R (can be read), RW (and set), or RWE (and stored in the EEPROM, with 'tmclctl store').

  tmclctl params x --values
  tmclctl params --model TMCM-1276
  tmclctl params --model TMCM-1276 --globals
)";

constexpr const char* get = R"(
Prints one bare number, so that a script needs no parsing. With --in-units its unit stands behind it,
as 'set' takes it.

  position=$(tmclctl get x actual_position)
  tmclctl get x max_velocity --in-units          5.9604644775mm/s
  tmclctl --direct tcp:127.0.0.1:4001 get 1/0 4
)";

constexpr const char* set = R"(
A bare number is what the module counts, on every axis. A position, velocity or acceleration may have
a unit, as 'get --in-units' prints it, and becomes the nearest value there is. The module forgets the value when it loses power, unless 'tmclctl store' keeps it.
Writing target_position, actual_position, target_velocity or ramp_mode can move the motor. What the
settings of a ramp then make of moves that nobody may want, such as a bow with which the motor swings,
is told as a warning.

  tmclctl set x max_velocity 1500
  tmclctl set x max_velocity 20000pps
  tmclctl set x max_acceleration 50mm/s^2
)";

constexpr const char* move = R"(
Comes back as soon as the module has accepted the move; with --wait when the axis stands at its
target. While it waits it draws a progress line, if standard error is a terminal. Ctrl-C ends the
waiting and NOT the move: it tells how to stop the axis and exits with 130.

On an axis with a unit, POSITION needs one: 10mm, or 10microsteps. Bare numbers other than 0 count
microsteps only on axes without a unit, and with --internal.

  tmclctl move x 10mm
  tmclctl move x 51200 --internal
  tmclctl move x 1.5rev
  tmclctl move x -1000 --by --wait
  tmclctl move x 0.1mm --by --wait               again and again: what is rounded does not add up
  tmclctl move x 0 --wait --timeout 30
)";

constexpr const char* wait = R"(
Comes back when all of them stand at their targets, whoever sent them there; one that swings about its
target does not stand there, and a warning says why it swings. An axis that is stopped
short of its target ends it (exit code 5). Ctrl-C ends the waiting and NOT the moves.

  tmclctl move x 10mm; tmclctl move y 0; tmclctl wait x y
  tmclctl wait x --timeout 30 && echo there
)";

constexpr const char* line = R"(
The axes start together and arrive together: each gets the part of speed and acceleration that its
way is of the longest. Their own settings are the limits, and are set back at the end; --velocity and
--acceleration are limits of each axis, too. If one cannot take part, none moves; if one is stopped or
does not go as planned, all are stopped. Several motors of one module start with one command. With
--direct it stays until all axes stand and have their settings back; Ctrl-C stops them.

  tmclctl line x=51200microsteps y=-1.5rev --wait
  tmclctl line x=10mm y=2.5mm z=0
  tmclctl line x=10mm y=2.5mm --velocity 5mm/s
  tmclctl line x=10mm y=2.5mm --time 4
)";

constexpr const char* rotate = R"(
Turns until it is stopped: to the right for a positive velocity, to the left for a negative one. An
axis with soft limits does not turn without end. On an axis with a unit, VELOCITY needs one; --internal
takes it as the module counts. max_velocity (parameter 4) holds for positions: modules with a TMC429 open
it for ROR and ROL, and others have another register, so a faster VELOCITY is taken, with a warning. What
is above max_velocity in the configuration is refused.

It shows the axis until Ctrl-C, SIGTERM or SIGHUP, and stops it then. If this program is killed, tmcld
stops the axis; with --direct nobody does. With --unattended it comes back at once, and the axis turns
on until it is stopped.

  exit 0   stopped; with --unattended, or a velocity of zero: it was told so
       4   the stop was not confirmed: it may still turn
       5   it does not turn any more, although it was not stopped from here

  tmclctl rotate x -5mm/s
  tmclctl rotate x -500 --internal
  tmclctl rotate x 2rps
  tmclctl rotate x 61035pps --unattended
)";
constexpr const char* lease = R"(
Who has a lease of axes is the only one who can move them, or change the settings of their modules;
everybody can read and stop. 'lease run' takes one, runs COMMAND, and ends with its exit code. The
lease is renewed as long as COMMAND runs; then the axes are stopped. Every tmclctl that COMMAND starts
moves them under this lease: it is passed on in TMCL_LEASE and TMCL_EPOCH. If this program is killed or
hangs, the axes stop.

  exit     that of COMMAND
       5   the lease was lost; COMMAND was sent SIGTERM

  tmclctl lease run x y -- ./measure.sh
  tmclctl lease list
  tmclctl lease break x
)";

constexpr const char* token = R"(
A token lets a client in from the network, by [http] of tmcld's configuration, with the role that it was
made for: observe, operate or configure, each with what is before it. It is printed once; tmcld keeps a
hash of it. 'token revoke' ends the connections and the leases of whoever uses it. All of this needs the
role configure.

  tmclctl token add --role operate --name lab
  tmclctl --url https://gateway.example:4143 --token-file lab.token axes
  tmclctl token list
  tmclctl token revoke lab
)";

constexpr const char* stop = R"(
Ramps down to standstill. A stop goes out before everything else. Through tmcld it says within a
second that the module has taken it; if it cannot, it says so and exits with 3 (nothing was sent) or 4
(nobody knows). That is no emergency stop: such a one cuts the power.
--all, or 'all' where no axis is called so, stops every axis that tmcld knows; with --direct it looks for modules at the addresses 1 to
255 and stops each as soon as it is found.

  tmclctl stop x
  tmclctl stop --all
)";

constexpr const char* watch = R"(
One line for each change of some axes or of all, until Ctrl-C (exit code 0) or the end of --for, in the
unit of the axis if it has one. With --json, one document a line. It stays while modules do not answer, a
bus is lost or tmcld starts again, and says so; documents of that have "event" or "away" instead of "axis".

  tmclctl watch x
  tmclctl watch --all
  tmclctl --json watch x y --interval 50 --for 10
)";

constexpr const char* top = R"(
One row for each axis: whether its module answers, its position, a bar from its lower soft limit to the
upper one, its velocity, and what else is to be known: latched, referenced, leased, unattended, why it
stands short of its target. It stays while modules do not answer or tmcld starts again. q or Ctrl-C ends
it; the axes go on. It needs a terminal: 'watch --all' writes lines.

  tmclctl top
)";

constexpr const char* buses = R"(
One row for each bus: its link, whether it is open, how much of what the wire carries was used while it
looked (only for serial lines, whose baud rate says that; the rate of a USB port means nothing), and since
tmcld started: requests without an answer in time (TIMEOUTS), answers that came too late (LATE), bytes that
belong to no datagram (GARBAGE), replies that nobody asked for (SURPLUS), and answers that were given out
only when they had been proven (SUSPECT). A bus that is not open says why.

  tmclctl buses
  tmclctl buses --for 10
  tmclctl --json buses
)";

constexpr const char* trace = R"(
One line for each datagram that tmcld sends over a bus or gets from it, for whichever client: when (UTC),
-> to the modules or <- from them, the bytes as they were on the wire, what they mean (beginning with the
address of the module), and who asked: a process, a token, a port. Nobody: tmcld itself. On CAN, the
identifier of the frame comes first. What belongs to no datagram is shown as garbage.

tmcld remembers the last 4096 datagrams of each bus at any time: after something went wrong, --last shows
what was before. -w writes a pcapng file (link type USER0) that Wireshark shows with tmcl.lua, which is in
the folder wireshark beside the examples; --read shows such a file here, and 'tmclsim --replay' asks
virtual modules the same. Ctrl-C ends it (exit code 0).

  tmclctl trace bench
  tmclctl trace bench --last 200 --for 0.1
  tmclctl trace bench -w bench.pcapng --for 60
  tmclctl trace --read bench.pcapng
  tmclctl trace bench -w -                     for a pipe: | wireshark -k -i -
)";

constexpr const char* plot = R"(
Records position and velocity, and draws both over time. With --to or --by it starts that move and
records until the axis stands; otherwise it records until the axis stands, or for the time that
--for gives. Ctrl-C ends the recording, not the move, and draws what there is. An axis with a unit is
drawn in that, and its CSV has two columns more.

--compare draws beside the movement what the module's ramp generator should make of it, and says by
how much the two differ: beyond what the time can explain that command and readings took.

  tmclctl plot x --by 51200
  tmclctl plot x --by 51200 --compare
  tmclctl plot x --to 0 --svg move.svg --csv move.csv
  tmclctl rotate x 500 --unattended; tmclctl plot x --for 3
  tmclctl plot x --by 1000 --csv -               CSV on standard output, no drawing
)";

constexpr const char* capture = R"(
Has the module record parameters of the axis at the ticks of its own clock (command 142, RAMDebug),
many times faster than a bus could ask for them, and reads the recording afterwards: as CSV, with the
time from the trigger on, and values as the module counts them. Few modules have this, and no manual
says which.

--rate is the module's own rate or a whole part of it; without --samples or --for the recording
fills the module's buffer. Reading takes about 2 ms for each value at 115200 baud; others use the bus
meanwhile, and while axes of that bus are led along a path, this waits.

Ctrl-C ends the recording and frees the module. What an error ends, such as a lost connection, is
taken up again by the same command with --resume.

  tmclctl capture x --channel actual_position --channel actual_velocity --samples 1000
  tmclctl capture x --channel actual_velocity --rate 500Hz --for 4 --csv start.csv
  tmclctl capture x --channel actual_position --channel actual_velocity --rate 1kHz \
      --trigger 'actual_velocity rising 100' --pretrigger 20% --svg start.svg
)";

constexpr const char* home = R"(
Waits until the module says that its search has ended, unless --no-wait is given. Ctrl-C ends the
waiting and NOT the search; 'tmclctl home x --stop' or 'tmclctl stop x' ends that. A search that
another program ends has found nothing, and is told so.

A search whose switch is dead goes on for ever. So it is stopped (exit code 5, cause search_limit)
where it goes further one way, without turning, than --max-travel says, else 'home_max_travel' in the
configuration, else the length of its soft limits and a tenth. Where none of them is given nothing
bounds it, and a warning says so. With --direct --no-wait nothing watches it when tmclctl has ended.

--timeout stops the search, too; with --leave it goes on.

  tmclctl home x
  tmclctl home x --max-travel 120mm
  tmclctl home x --mode 5 --timeout 60
  tmclctl home x --stop
)";

constexpr const char* recover = R"(
When a module has started again, or is another one than before, tmcld moves its axes no more: where
they are, and how they are set up, is what the module starts with. 'tmclctl home x' finds the place
again. Where none is needed, or somebody has looked, this says that the axis may move. The settings are
not put back: what is not stored in the module (see 'tmclctl store') has to be set again.

  tmclctl recover x
  tmclctl recover --all
)";

constexpr const char* errors = R"(
Asks the modules of all axes, or of one, what they know about themselves: stops by stallGuard or the
encoder, what the driver reports (too hot, shorts, coils that are not connected), closed switches, and
supply and temperature where the module measures them. Reading clears the flags 'stall' and 'deviation';
the column STOPPED BY keeps them until the axis moves again. Coils can be told to be open only while
the motor turns slowly. A supply below 7 V is 'undervoltage'. If anything is wrong, the exit code is 1.

  tmclctl errors
  tmclctl --json errors x
)";

constexpr const char* deadman = R"(
A module can stop its motors by itself when nobody has sent it anything for a time: when this computer
has failed, tmcld hangs, or the cable is cut. The time is kept in the module's EEPROM, and holds for every
other host, too, and for programs in the module: one that starts a program by itself is not set. tmcld
sends something to a module that it has set in every third of the time; 'deadman_ms' in its configuration
sets it for good. With --direct it holds from the moment on at which tmclctl ends.

That a module keeps the time does not prove that it heeds it. 'test' turns the axis for some tenths of a
turn within its soft limits, not faster than its max_velocity, sends its module nothing for four times the
time, and tells when it has stopped. All its other motors must stand. Other calls to the module wait until
then; a stop, or Ctrl-C, ends the test. tmcld remembers what was found: 'tmclctl --json modules' shows it.

  exit 0   'test': the module has stopped its motor
       5   'test': it has not, or its deadman is off

  tmclctl deadman set x 1000
  tmclctl deadman test x
  tmclctl deadman off x
)";

constexpr const char* verify_module = R"(
What a move will do is foreseen by a twin of the module's ramp generator, and some of what chips and
firmware do is in no document. This finds it out: small, slow moves, up to a hundred microsteps, and some
questions. Each move is watched, and every known variant that could not have moved like this is out. The
table says for each trait what the twin has, what the module was found to be, and how that is known, or
why it is not: a trait whose variants differ by milliseconds does not show on a line of 9600 baud.

The axis ends where it began, and has the settings that it had. Currents are never touched. A value out of
range is sent that a module without a check cuts to what it has, and one question to an address that no
module here has. Nobody else can move or set the axis meanwhile; a stop, or Ctrl-C, ends it: the axis stands
then, and gets its settings back. It takes a minute or less.

--report writes a file that says all this, for a person and for programs: 'tmclsim --module MODEL --as FILE'
makes a simulated module like it, and 'as' in a [[module]] of tmcld.toml a twin.

  tmclctl verify x --travel -2mm..2mm
  tmclctl verify x --yes --report x.toml
  tmclctl verify 1/0 --travel -100..100 --yes --report -
)";

constexpr const char* coordinate = R"(
Coordinates 0 to 20 are lost with the module's power, unless they are stored; 0 never is.

  tmclctl coordinate capture x 1
  tmclctl coordinate set x 2 12.5mm
  tmclctl coordinate move x 1
  tmclctl coordinate get x 1
  tmclctl coordinate store x; tmclctl coordinate load x
)";

constexpr const char* coordinate_start = R"(
Each motor goes to its own coordinate of this number. Only modules with several motors know this,
and how they are named on the wire is our reading of the manuals: try it where nothing can break.

  tmclctl coordinate set x 1 51200; tmclctl coordinate set y 1 25600
  tmclctl coordinate start 1 1 0 1 --arrive-together
)";

constexpr const char* arrivals = R"(
Asks the module to tell whenever one of these motors reaches the target of a move that starts from
now on, and shows that until Ctrl-C or the end of --for; with --next until each has arrived once. The
module goes on telling then: --off ends that. With --json, one document a line.

  tmclctl arrivals 1 0 1 2
  tmclctl arrivals 1 0 --next
  tmclctl arrivals 1 --off
)";

constexpr const char* global = R"(
Names are those of bank 0. Parameters 64 to 127 of bank 0 are stored at once; some, such as the
address, take effect at once, too, or after a reset.

  tmclctl global get 1 can_bit_rate
  tmclctl global set bench:1 5 4711 --bank 2     user variable 5
  tmclctl global store 1 5 --bank 2              its value now is what it starts with ...
  tmclctl global restore 1 5 --bank 2            ... and has again
)";

constexpr const char* input = R"(
Prints one bare value. Port 255 of bank 0 is all digital inputs, a bit each.

  tmclctl input 1 0
  tmclctl input 1 0 --bank 1                     as the converter gives it
)";

constexpr const char* output = R"(
Without a VALUE it prints one bare value: what the output is set to.

  tmclctl output 1 0 1                           switch it on
  tmclctl output 1 0
)";

constexpr const char* info = R"(
What the module does not tell is "-".

  tmclctl info 1
  tmclctl info bench:1
)";

constexpr const char* reset = R"(
The module starts anew, as after a loss of power: its motors stop, it forgets where they are, and its
parameters are those that were stored. It does not answer meanwhile.

  tmclctl reset 1
)";

constexpr const char* factory_reset = R"(
The module does not answer, and restarts. It may come back with another address and baud rate.

  tmclctl factory-reset 1 --yes
)";

constexpr const char* upload = R"(
FILE is assembled (see 'tmclctl program assemble --help') or, if its name ends in .bin, taken as it
is. While it is loaded, everybody else's commands to that module wait. A stop does not: it ends the
upload. The first command is loaded last, so no half of a program can ever run. Needs a module
whose program does not run, and is not protected (global parameter 81).

  tmclctl program upload loop.tmc 1 --run
  tmclctl --direct serial:/dev/ttyACM0 program upload loop.bin 1
)";

constexpr const char* download = R"(
Prints the program as text that 'tmclctl program assemble' makes the same program of. Ends after 16
empty commands, unless --length says how many there are.

  tmclctl program download 1 -o saved.tmc
)";

constexpr const char* raw = R"(
Sends one command as it is and shows the bytes of request and reply. COMMAND and TYPE are numbers
or names. Numbers may be hexadecimal: 0x43 or $43. Through tmcld the reply's bytes are put together again from what tmcld says.

An axis that is set turning without end (ROR, ROL, SAP 2), or may be by a register of its chip (WRITE_MC,
WRITE_DRV), is stopped when this program ends, and a warning says so; 'tmclctl rotate' stays, or lets
the axis turn unattended. The same holds for 'tmclctl set' of target_velocity or ramp_mode.

  tmclctl --direct serial:/dev/ttyACM0 raw 1 GAP actual_position 0 0
  tmclctl raw --bus bench 1 GET_FIRMWARE_VERSION 1 0 0
  tmclctl raw 1 MVP ABS 0 51200
)";

constexpr const char* ramp = R"(
On a module with a TMC429 it chooses pulse divider, ramp divider, max_velocity and max_acceleration so
that they come as near to the wish as the chip can, and a minimum_velocity with which the last
microstep takes no longer than the others; on other modules it sets max_velocity and all
accelerations of a ramp. It shows what they give, and refuses while the axis moves. A wish that
cannot be met is refused with the nearest value that can.
The dividers scale the other speeds of the axis, too, such as those of the reference search.

On a TMC457 --jerk makes S-shaped ramps: the greatest bow that does not exceed it and with which the
motor does not swing around its target; max is the greatest of these. A jerk below that of the
smallest bow, 909495pps/s^2, is refused, and so is any jerk but max on a module without bows. Without
--jerk the bow is left as it is, and 'tmclctl set x max_bow 0' switches it off. The last line says how long it takes to come
up to speed, and how far that is.

  tmclctl ramp x --velocity 50000pps --acceleration 200000pps/s
  tmclctl ramp x --velocity 20mm/s --acceleration 100mm/s^2 --deceleration 50mm/s^2
  tmclctl ramp x --velocity 20mm/s --acceleration 100mm/s^2 --jerk max --dry-run
)";

constexpr const char* convert = R"(
Rounds to what such a module can hold, and shows that in all units. A bare number counts in the
module's own unit, and is shown as a position, a velocity and an acceleration. Dividers and unit
mode are those that the model starts with, if they are not given. With --acceleration QUANTITY is a
velocity, and the time and the length of the ramp from rest to it are shown: S-shaped with --bow.

  tmclctl convert --model TMCM-1110 61035pps
  tmclctl convert --model TMCM-1110 --pulse-div 5 --ramp-div 7 500
  tmclctl convert --model TMCM-6212 --microsteps 64 2rps
  tmclctl convert --model TMCM-142 --bow 11
  tmclctl convert --model TMCM-142 1000000pps/s^2
  tmclctl convert --model TMCM-142 40000pps --acceleration 400000pps/s --bow 9
)";

constexpr const char* profile = R"(
Nothing is sent anywhere: no bus, no tmcld, no module is needed.

  tmclctl profile simulate --help      registers of a chip: how it moves
  tmclctl profile solve --help         some values of a trapezoid: all of them
)";

constexpr const char* simulate = R"(
Computes, exactly to the tick (tmc4361: by a model), how a chip's ramp generator moves: from rest at
position 0 and tick 0 until it stands on its target, or until --until. Draws position and velocity;
--csv, --svg and --json say it in other ways. x is in microsteps, v and a are in the chip's units.

  tmclctl profile simulate --generator tmc429 v_max=1000 a_max=500 pulse_div=2 ramp_div=3 \
      x_target=100000
  tmclctl --json profile simulate --generator sixpoint amax=3000 vmax=268000 dmax=3000 \
      d1=3000 xtarget=512000 --sample 0.5,1
  tmclctl profile simulate --generator tmc457 v_max=5000000 a_max=24624 d_max=24624 bow_max=11 \
      x_target=50000 --csv 0.01
  tmclctl profile simulate --generator tmc4361 vmax=25600000 amax=800000 dmax=400000 \
      bow1=1000000 bow2=2000000 bow3=500000 bow4=400000 xtarget=300000
  tmclctl profile simulate --generator mc1451a profile=s_curve velocity=180224 acceleration=66 \
      jerk=42950 position=100000 --svg s_curve.svg
  tmclctl profile simulate --generator tmc429 mode=velocity v_max=2047 a_max=100 pulse_div=3 \
      ramp_div=5 v_target=500 --change 0.5:v_target=-500 --until 2

Registers are called as in the data sheets; values are decimal, 0x..., or these names:
  tmc429    mode=ramp|soft|velocity|hold v_min v_max v_target v_actual a_max pulse_div ramp_div
            x_target x_actual; pmul and pdiv follow from a_max and the dividers if not given;
            v_min is 1 if not given, as the modules' firmware writes it. What no data sheet tells:
            last_step=r3|r1|r2
            factor_rule=percent_99|percent_95|percent_98_8|nearest|nearest_less_one
            order=ramp_first|pulse_first accumulator=cleared|kept
  tmc457    mode=position|velocity|hold v_max v_target a_max d_max d_stop bow_max x_target
  tmc4361   rampmode=position|velocity vmax amax dmax bow1 bow2 bow3 bow4 xtarget, S-shaped ramps
            only: a model, not exact to the tick; clk_freq is to be f_clk if that is given
  sixpoint  (TMC5130, TMC5160, TMC5072) rampmode=position|velocity_positive|velocity_negative|hold
            vstart a1 v1 amax vmax dmax d1 vstop tzerowait xtarget; vstop is vstart, and at least
            10, if not given
  mc1451a   profile=s_curve|trapezoidal position velocity acceleration jerk; steps and cycles.
            With a point, velocity=2.75 is in steps/cycle, and so on; both forms are shown
f_clk=HZ is the chip's clock (100 kHz to 100 MHz; 16 MHz if not given); mc1451a counts times in
cycles wherever SECONDS are meant. Mode and target are written last, whatever the order here.

A change acts after everything up to its instant; changes of one instant act in the order given.
--json prints {"generator", "duration_s", "final_position", "peak_velocity", "ramp_up": {"duration_s",
"microsteps"}, "ramp_down": likewise, "phases": [{"name", "start_s"}], "samples": [{"t", "x", "v",
"a"}]}; duration_s is when it last came to rest on its target, null if it does not. The ramps are what
comes before it is first as fast as it gets, and after that, until it stands there; text says so, too.
What the chip would take but should not be told is a warning on standard error; settings that
contradict each other are an error (exit code 2).
)";

constexpr const char* solve = R"(
A movement that accelerates, goes at constant speed and decelerates has eight values, of which four
that do not follow from each other determine the rest:
  distance, speed, acceleration, deceleration, acceleration_time, slew_time (at constant speed),
  deceleration_time, total_time
It goes from rest to rest, unless initial_speed and final_speed, both below speed, are given. The
distances of the parts may be given, too, each with another value of the same part:
  acceleration_distance, slew_distance, deceleration_distance
With an assumption, fewer are enough:
  symmetric  both ramps are equal: one acceleration, and one time if both ends have the same speed
  thirds     symmetric, and each of the three parts takes a third of the time; between ends with
             different speeds the times are equal, and not the accelerations

  tmclctl profile solve distance=20mm total_time=600ms thirds
  tmclctl profile solve speed=8 acceleration=16 deceleration=16 distance=12
  tmclctl profile solve distance=90deg speed=1rev/s acceleration=5rev/s^2 symmetric
  tmclctl --json profile solve distance=200mm total_time=1s speed=250mm/s symmetric
  tmclctl profile solve initial_speed=2 speed=8 acceleration=3 deceleration=3 distance=40

Prints all of them as a table and draws position and speed; --svg draws into a file; --json prints
them as plain numbers, and "unit". Lengths may be in any unit, all of them in the same one; mm, um,
cm, m and in, and deg, rad and rev, can be mixed. Speeds are such as mm/s, accelerations mm/s^2 (or
mm/s2, mm/s/s); times are in s, ms, us or min. What is printed is in seconds and in the first unit
of length that was given, and bare numbers are taken as such.

More than enough may be given, as long as it agrees within 1e-9. Too little, values that contradict
each other, and what is impossible are errors that say so, with a way out (exit code 2).
)";

constexpr const char* mint = R"(
  tmclctl mint check --help
  tmclctl mint run --help
)";

constexpr const char* mint_run = R"(
Runs a program as 'tmclctl mint check' reads it. Positions are counts: SCALE microsteps are a user unit,
or, with --counts encoder, SCALE counts of the axis' encoder, which the configuration must know.
Each GO sets the ramps of its axes to SPEED, ACCEL and DECEL, starts them together, and waits until all
stand. Axis 0 is the first that 'tmclctl axes' lists, unless --axis says which is which. Nothing moves
unless every axis is there, stands, and can go everywhere the program sends it. Ctrl-C stops all axes.
The ramps' parameters are set back at the end.

  tmclctl mint run exercise.mint
  tmclctl mint run two.mint --axis 0=x --axis 1=y
  tmclctl mint run exercise.mint --axis 0=z --counts encoder
)";

constexpr const char* path = R"(
  tmclctl path check --help
  tmclctl path run --help
  tmclctl path pause --help
)";

constexpr const char* path_check = R"(
Plans a path as 'tmclctl path run' would, for axes that can do what --velocity and --acceleration say,
and says how long it is and takes, where it goes, and where it is slowest. Lengths are in the units of
the file; G-code's are mm (deg for A B C). Where X, Y or Z moves, the length is theirs, and A B C go
along. All that is wrong comes as FILE:LINE:COLUMN: MESSAGE, up to 20 problems.

--legs says for each leg when it begins (T1), has its speed (T2), slows down (T3) and ends (T4), and the
ramp of each axis, as ramp generators take it: start, greatest and stop velocity, both accelerations.

  tmclctl path check part.ngc --velocity 20 --acceleration 500
  tmclctl path check part.csv --svg part.svg
  tmclctl path check part.ngc --legs --microsteps-per-unit 10240
  tmclctl --json path check part.ngc
)";

constexpr const char* path_run = R"(
Moves the axes along the path, and says then how far off it they were seen, and what the bus was used
for. G-code begins where the axes stand; to the start of a table they are moved first. X is the axis of
tmcld that is called X or x, unless --axis says otherwise. Nothing moves before everything is checked:
units, limits, where the path goes, that all axes stand, and what the bus can carry. Files are those of
'tmclctl path check'. --velocity, --acceleration and --feed are in the units of the file, or have a unit
with them: 20mm/s, 500mm/s^2, 120rpm.

  --mode velocity   any module: a new velocity for each axis every 5 ms, or as fast as the bus can
  --mode segments   any module, for slow buses: an axis is told a speed, and the acceleration to get
                    there, only where its speed changes; no table with times
  --mode position   modules with start and stop velocities (TMC5130, TMC5160 ...): line by line; no table
                    with times
Ctrl-C stops all axes. So does a stop of one of them by another client, an axis that does not do what it
is told, and a computer or bus that is too slow. Ctrl-Z pauses on the path, and goes on.
tmcld passes the path: once begun, it goes on to its end also if this program is killed. With --direct
there is nobody else who could: if this program is killed, each axis stops at the end of its leg, in the
other modes where the path would next turn it round; those of a TMC4361 or of firmware ramps turn on.

  tmclctl path run part.ngc --axis X=left --axis Y=front
  tmclctl path run part.csv --axis x=left --axis y=front --mode position --velocity 20mm/s
  tmclctl --direct can:can0 path run part.ngc --axis X=1/0 --axis Y=1/1 --per-turn 5 --dry-run
)";

constexpr const char* path_steering = R"(
For paths that tmcld passes, whoever began them. A path in position mode pauses where it stands itself.

  tmclctl path pause left
  tmclctl path resume
  tmclctl path stop
)";

constexpr const char* mint_check = R"(
Reads a program of SCALE, SPEED, ACCEL, DECEL, MOVEA, MOVER and GO as application note AN00115-001
prints it, and says for each GO which axes go where, and when; all in the user units that SCALE
makes, and in seconds. No module is needed. What is wrong comes as FILE:LINE:COLUMN: MESSAGE (exit
code 2); a move that no GO starts is a warning.

  SCALE = 1200             ' counts of a user unit (1 if there is no SCALE)
  SPEED = 250              ' DECEL is ACCEL if it is not given
  ACCEL = 1250
  MOVER = 200              ' loads a move by 200; MOVEA one to 200
  GO                       ' starts all that are loaded

SPEED = 1, 2 is of the axes 0 and 1; SPEED.2 = 1 of axis 2; SPEED[0,2] = 1, 2 of the listed ones,
SPEED[0,2] = 1; the same for them. GO[0,2] starts those together.

  tmclctl mint check exercise.mint
  tmclctl --json mint check exercise.mint
)";

constexpr const char* firmware = R"(
  tmclctl firmware info --help
  tmclctl firmware check --help
  tmclctl firmware upload --help
)";

constexpr const char* firmware_info = R"(
Reads an Intel HEX file: how long it is, where it goes, its checksum as bootloaders compute it, and
the versions that it says it is, such as 1110V142. What is wrong with a file comes as
FILE:LINE:COLUMN: MESSAGE (exit code 2). No module is needed.

  tmclctl firmware info TMCM-1110_V1.42.hex
)";

constexpr const char* firmware_check = R"(
Asks the module which model it is and what it runs, and looks in the file for a version of this
model. Exit code 0 if there is one, otherwise 2. Nothing is changed.

  tmclctl firmware check TMCM-1110_V1.42.hex 1
)";

constexpr const char* firmware_upload = R"(
Stops the module's motors, enters its bootloader, erases the firmware, writes the new one, compares
the checksum and starts it. A file that is not for this model is refused before anything is changed;
--force takes it if the file does not say what it is for, or says it in an unknown way.
Through tmcld, everybody else's commands to the module fail meanwhile, stops too: in its bootloader
it can neither start nor stop a motor. The upload goes on to its end even if tmclctl is ended, or
tmcld is asked to end; with --direct the first Ctrl-C does not end it, but the second does. On a serial
line everything waits while the module erases, which may take some seconds.

Whatever fails once the firmware is erased, even the power: the module then stays in its bootloader.
Give the same command again. On USB the module may leave the bus when it enters its bootloader and
come back as another device: give the command again with that one's name.

  tmclctl firmware upload TMCM-1110_V1.42.hex 1
  tmclctl --direct serial:/dev/ttyACM0 firmware upload TMCM-1110_V1.42.hex 1
)";

constexpr const char* program = R"(
'assemble' and 'disassemble' only work on files. All others speak to the module that they name.

  tmclctl program assemble --help      a program's text: a file for the module
  tmclctl program upload --help        into the module
  tmclctl program run --help           and let it run
)";

constexpr const char* program_run = R"(
Comes back when the module has begun; the program goes on by itself. Without --start it goes on where
it stands; after 'tmclctl program reset' that is its first command.

  tmclctl program run 1
  tmclctl program run bench:1 --start 0
)";

constexpr const char* program_stop = R"(
The program ends; motors that turn go on turning: stop those with 'tmclctl stop AXIS'.

  tmclctl program stop 1; tmclctl stop --all
)";

constexpr const char* program_step = R"(
Executes the next command of the program, which then waits for another step. A command that moves a
motor moves it.

  tmclctl program step 1; tmclctl program status 1
)";

constexpr const char* program_reset = R"(
Ends the program; the next run begins at its first command. Motors that turn go on turning.

  tmclctl program reset 1
)";

constexpr const char* program_status = R"(
state is stopped, running, stepping (it also is while it stands at a breakpoint) or reset. What the
module does not tell is "-".

  tmclctl program status 1
  tmclctl --json program status 1
)";

constexpr const char* verify = R"(
Exit code 1 if the module holds another program, and where they differ first.

  tmclctl program verify loop.tmc 1
)";

constexpr const char* breakpoint = R"(
The program stands before the command at this address, and goes on by 'tmclctl program run'. Addresses
are those of the listing of 'tmclctl program assemble'.

  tmclctl program breakpoint 1 7
  tmclctl program clear-breakpoint 1 7
  tmclctl program clear-breakpoints 1
)";

constexpr const char* assemble = R"(
FILE is a program in the language of the TMCL-IDE:

  #include "speeds.tmc"             // beside this file
  Far = 2 * $C800                   // constants; ( ) - ~ * / % + & ^ |; $FF, 0xFF, %1010
  Loop: MVP ABS, 0, Far             /* labels, alone on a line or before a command */
        WAIT POS, 0, 0
        JA Loop
        .raw 250, 1, 2, 3           // any command by its numbers

#include TMCLParam.tmc, a file of the TMCL-IDE, makes names of axis parameters constants, such as
MaxVelocity; it need not be there. Some names have other numbers on other models: --model says which.

Without -o it prints the listing: address, bytes, line and text. The file that -o names gets eight
bytes for each command, as the TMCL-IDE and PyTrinamic read them; it is written only if there are no
problems. Each problem is a line FILE:LINE:COLUMN: MESSAGE on standard error (exit code 2).
--json prints {"file", "labels": [{"name", "address"}], "program": [{"address", "command", "type",
"motor", "value", "file", "line"}]}, or {"error": {..., "problems": [{"file", "line", "column",
"word", "message"}]}}.

  tmclctl program assemble loop.tmc
  tmclctl program assemble loop.tmc -o loop.bin
  tmclctl program assemble loop.tmc --model TMCM-1110
  tmclctl --json program assemble loop.tmc
)";

constexpr const char* disassemble = R"(
FILE has eight bytes for each command, as the TMCL-IDE, TMCLAsm and 'tmclctl program assemble' write
them. The text assembles to the same bytes; what is no command of a program becomes .raw COMMAND,
TYPE, MOTOR, VALUE. --json prints {"file", "commands", "text"}.

  tmclctl program disassemble loop.bin
  tmclctl program disassemble loop.bin -o loop.tmc
)";

}  // namespace tmclctl::help_text
