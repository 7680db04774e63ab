import type { ComponentChildren } from "preact";

interface TableOf {
  caption: string;
  heads: string[];
  children: ComponentChildren;
}

/** It scrolls in a frame of its own where it is wider or longer than the screen; the frame takes the keys for that. */
export function Table({ caption, heads, children }: TableOf) {
  return (
    <div class="table" role="group" aria-label={caption} tabIndex={0}>
      <table>
        <caption>{caption}</caption>
        <thead>
          <tr>
            {heads.map((head) => (
              <th scope="col">{head}</th>
            ))}
          </tr>
        </thead>
        <tbody>{children}</tbody>
      </table>
    </div>
  );
}

interface TextTableOf {
  caption: string;
  heads: string[];
  rows: string[][];
}

/** The first cell of a row is its name. */
export function TextTable({ caption, heads, rows }: TextTableOf) {
  return (
    <Table caption={caption} heads={heads}>
      {rows.map((cells) => (
        <tr>
          {cells.map((cell, index) => (index === 0 ? <th scope="row">{cell}</th> : <td>{cell}</td>))}
        </tr>
      ))}
    </Table>
  );
}
