import { useState } from "preact/hooks";
import { may } from "../access";
import { call } from "../bench";
import type { ProgramLine } from "../program";
import { texts } from "../texts";
import { Table } from "./table";

interface ProgramTableOf {
  module: { bus: string; address: number };
  lines: ProgramLine[];
  /** Of each command; null where it was made of no text here. */
  linesOfText: number[] | null;
  next: number | null;
  carryOut: (action: () => Promise<string>) => void;
}

/** The commands of a program, with the next one marked. Modules do not tell their breakpoints: those of this page are shown. */
export function ProgramTable({ module, lines, linesOfText, next, carryOut }: ProgramTableOf) {
  const [breakpoints, setBreakpoints] = useState<number[]>([]);
  const mayBreak = may("program.set_breakpoint");
  const toggle = async (at: number) => {
    const isSet = breakpoints.includes(at);
    await call(isSet ? "program.clear_breakpoint" : "program.set_breakpoint", { ...module, at });
    setBreakpoints(isSet ? breakpoints.filter((one) => one !== at) : [...breakpoints, at]);
    return "";
  };
  const heads = [
    texts.programAddress,
    texts.command,
    texts.type,
    texts.motor,
    texts.value,
    ...(linesOfText ? [texts.lineOfText] : []),
    ...(mayBreak ? [texts.breakpoint] : []),
  ];
  return (
    <Table caption={texts.program} heads={heads}>
      {lines.map((line) => (
        <tr key={line.address} aria-current={line.address === next ? "step" : undefined}>
          <td class="number">{line.address}</td>
          <th scope="row">{line.mnemonic}</th>
          <td class="number">{line.type}</td>
          <td class="number">{line.motor}</td>
          <td class="number">{line.value}</td>
          {linesOfText && <td class="number">{linesOfText[line.address]}</td>}
          {mayBreak && (
            <td>
              {/* A check box would take the space bar, which stops. */}
              <button
                aria-pressed={breakpoints.includes(line.address)}
                aria-label={texts.breakAt(line.address)}
                onClick={() => carryOut(() => toggle(line.address))}
              >
                {breakpoints.includes(line.address) ? texts.breakpointSet : texts.breakpointClear}
              </button>
            </td>
          )}
        </tr>
      ))}
    </Table>
  );
}
