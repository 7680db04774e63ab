import { may } from "../access";
import { call, isConnected } from "../bench";
import { clockText } from "../clock_text";
import type { Answer } from "../rpc";
import { texts } from "../texts";
import { Table } from "./table";
import { usePoll } from "./use_poll";

const lookEveryMs = 1000;
const linesShown = 100;

type Client = Answer<"client.list">["clients"][number];
type Line = Answer<"audit.tail">["lines"][number];

/** Who is connected, and what was done by whom, where the role allows to see that. */
export function BusConnected() {
  return (
    <>
      {may("client.list") && <Clients />}
      {may("audit.tail") && <Audit />}
    </>
  );
}

function Clients() {
  const isOpen = isConnected.value;
  const { answer, problem } = usePoll(() => call("client.list", {}), lookEveryMs, [isOpen]);
  const heads = [texts.client, texts.door, texts.role, texts.token, texts.axes, texts.since, texts.underWay];
  return (
    <>
      {isOpen && problem && <p class="problem">{problem}</p>}
      <Table caption={texts.connectedClients} heads={heads}>
        {(answer?.clients ?? []).map((one) => (
          <ClientRow client={one} />
        ))}
      </Table>
    </>
  );
}

function ClientRow({ client }: { client: Client }) {
  return (
    <tr>
      <th scope="row">{client.client}</th>
      <td>{texts.doors[client.door] ?? client.door}</td>
      <td>{client.role}</td>
      <td>{client.token ?? texts.notKnown}</td>
      <td>{client.axes.join(", ") || texts.notKnown}</td>
      <td class="number">{`${client.since_s.toFixed(0)} ${texts.seconds}`}</td>
      <td class="number">{client.requests}</td>
    </tr>
  );
}

function Audit() {
  const isOpen = isConnected.value;
  const { answer, problem } = usePoll(() => call("audit.tail", { lines: linesShown }), lookEveryMs, [isOpen]);
  const lines = answer?.lines ?? [];
  return (
    <>
      {isOpen && problem && <p class="problem">{problem}</p>}
      <Table caption={texts.audit(linesShown)} heads={[texts.number, texts.timeUtc, texts.doneBy, texts.whatWasDone]}>
        {[...lines].reverse().map((line) => (
          <tr key={line.number}>
            <td class="number">{line.number}</td>
            <td>{clockText(line.utc_us)}</td>
            <td>{doneBy(line)}</td>
            <td class="words">{line.text}</td>
          </tr>
        ))}
      </Table>
    </>
  );
}

function doneBy({ uid, pid }: Line): string {
  return uid == null ? texts.notKnown : texts.processOf(pid ?? 0, uid);
}
