import { may } from "../access";
import { axes, call, isConnected } from "../bench";
import { clientsIn, type Trace } from "../bus_trace";
import type { Answer } from "../rpc";
import { texts } from "../texts";
import { Table } from "./table";
import { usePoll } from "./use_poll";

const lookEveryMs = 1000;

type Lease = Answer<"lease.list">["leases"][number];
type Token = Answer<"token.list">["tokens"][number];

/** Who has an axis, who asks, and who may do what. */
export function BusClients({ bus, trace }: { bus: string; trace: Trace }) {
  const isOpen = isConnected.value;
  const mayTokens = may("token.list");
  const { answer: leased } = usePoll(() => call("lease.list", {}), lookEveryMs, [isOpen]);
  const { answer: known } = usePoll(
    () => (mayTokens ? call("token.list", {}) : Promise.resolve({ tokens: [] })),
    lookEveryMs,
    [isOpen, mayTokens],
  );
  const tokens = known?.tokens ?? [];
  return (
    <>
      <Holders leases={leased?.leases ?? []} />
      <Table caption={texts.askersOf(bus)} heads={[texts.client, ...(mayTokens ? [texts.role] : []), texts.questions, texts.lastTime]}>
        {clientsIn(trace).map((client) => (
          <tr key={client.name}>
            <th scope="row">{client.name}</th>
            {mayTokens && <td>{roleOf(client.name, tokens)}</td>}
            <td class="number">{client.questions}</td>
            <td>{client.lastTime}</td>
          </tr>
        ))}
      </Table>
      {mayTokens && <Tokens tokens={tokens} />}
    </>
  );
}

/** By the token that a client has shown. */
function roleOf(client: string, tokens: Token[]): string {
  return tokens.find((token) => client.startsWith(`token '${token.name}' from `))?.role ?? texts.notKnown;
}

/** Those with a lease, and those for whom an axis turns. */
function Holders({ leases }: { leases: Lease[] }) {
  const turning = axes.value.filter(({ state }) => state?.owner != null && state.lease === null);
  return (
    <Table caption={texts.holders} heads={[texts.axes, texts.client, texts.leaseNumber, texts.since, texts.expires]}>
      {leases.map((one) => (
        <tr key={one.lease}>
          <th scope="row">{one.axes.join(", ")}</th>
          <td>{one.holder}</td>
          <td class="number">{one.lease}</td>
          <td class="number">{`${one.since_s.toFixed(0)} ${texts.seconds}`}</td>
          <td class="number">{`${(one.expires_ms / 1000).toFixed(1)} ${texts.seconds}`}</td>
        </tr>
      ))}
      {turning.map(({ info, state }) => (
        <tr key={info.name}>
          <th scope="row">{info.name}</th>
          <td>{state!.owner}</td>
          <td colSpan={3}>{texts.turnsWithoutLease}</td>
        </tr>
      ))}
    </Table>
  );
}

function Tokens({ tokens }: { tokens: Token[] }) {
  return (
    <Table caption={texts.tokens} heads={[texts.token, texts.role, texts.made]}>
      {tokens.map((one) => (
        <tr key={one.name}>
          <th scope="row">{one.name}</th>
          <td>{one.role}</td>
          <td>{one.made}</td>
        </tr>
      ))}
    </Table>
  );
}
