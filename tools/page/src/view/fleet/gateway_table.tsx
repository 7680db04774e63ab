import type { ComponentChildren, RefObject } from "preact";
import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import type { Gateway } from "../../fleet/fleet";
import { rowsOf, windowOf } from "../../fleet/rows";
import type { Row } from "../../fleet/rows";
import { fleet, frame, status, want } from "../../fleet/session";
import { texts } from "../../fleet/texts";
import { AxisRow, GatewayRow } from "./gateway_rows";

const usualRowHeight = 44;

/** Only what is in sight of it is in the page, and only of that telemetry is wished for. */
export function GatewayTable({ pattern }: { pattern: string }) {
  frame.value;
  const frameOf = useRef<HTMLDivElement>(null);
  const [seen, setSeen] = useState({ top: 0, height: 0 });
  const rows = useMemo(() => rowsOf(fleet.gateways(), pattern), [fleet.generation, pattern]);
  const rowHeight = useRowHeight(frameOf, rows.length > 0);
  const { first, end } = windowOf(rows.length, seen.top, seen.height, rowHeight);
  const shown = rows.slice(first, end);
  useView(frameOf, setSeen);
  useWishes(shown);
  return (
    <>
      <div class="table fleet" role="group" aria-label={texts.table} tabIndex={0} ref={frameOf}>
        <table aria-rowcount={rows.length + 1}>
          <thead>
            <tr>
              {texts.heads.map((head) => (
                <th scope="col">{head}</th>
              ))}
            </tr>
          </thead>
          <tbody>
            <Space height={first * rowHeight} />
            {shown.map((row, index) => (
              <LineOf key={`${row.gateway.name}/${row.axis}`} row={row} number={first + index + 2} />
            ))}
            <Space height={(rows.length - end) * rowHeight} />
          </tbody>
        </table>
      </div>
      {rows.length === 0 && status.value.is === "open" && <p class="notice">{fleet.gateways().length === 0 ? texts.noGateways : texts.noneFits}</p>}
    </>
  );
}

/** The fleet gives an object anew for what has changed. */
function LineOf({ row, number }: { row: Row; number: number }): ComponentChildren {
  const gateway: Gateway = row.gateway;
  return row.axis === "" ? <GatewayRow gateway={gateway} number={number} /> : <AxisRow gateway={gateway} axis={row.axis} number={number} />;
}

/** In place of lines that are out of sight. */
function Space({ height }: { height: number }) {
  return height > 0 ? <tr aria-hidden="true" class="space" style={{ height: `${height}px` }} /> : null;
}

/** They all have that of the first one, which depends on the letters. */
function useRowHeight(frameOf: RefObject<HTMLDivElement>, hasRows: boolean): number {
  const [height, setHeight] = useState(usualRowHeight);
  useEffect(() => {
    const row = frameOf.current?.querySelector("[data-row]");
    if (row) setHeight(row.getBoundingClientRect().height || usualRowHeight);
  }, [hasRows]);
  return height;
}

function useView(frameOf: RefObject<HTMLDivElement>, setSeen: (seen: { top: number; height: number }) => void): void {
  useEffect(() => {
    const element = frameOf.current!;
    const look = () => setSeen({ top: element.scrollTop, height: element.clientHeight });
    const size = new ResizeObserver(look);
    size.observe(element);
    element.addEventListener("scroll", look, { passive: true });
    return () => {
      size.disconnect();
      element.removeEventListener("scroll", look);
    };
  }, []);
}

function useWishes(shown: Row[]): void {
  const names = [...new Set(shown.map(({ gateway }) => gateway.name))];
  useEffect(() => want(names), [names.join(" ")]);
  useEffect(() => () => want([]), []);
}
