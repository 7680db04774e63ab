import { may } from "../access";
import type { ProgramLine } from "../program";
import { texts } from "../texts";
import { Table } from "./table";

interface ProgramTableOf {
  lines: ProgramLine[];
  /** Of each command; null where it was made of no text here. */
  linesOfText: number[] | null;
  next: number | null;
  /** Addresses. */
  breakpoints: number[];
  toggleBreakpoint: (at: number) => void;
}

/** The commands of a program, with the next one marked. */
export function ProgramTable({ lines, linesOfText, next, breakpoints, toggleBreakpoint }: ProgramTableOf) {
  const mayBreak = may("program.set_breakpoint");
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
                onClick={() => toggleBreakpoint(line.address)}
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
