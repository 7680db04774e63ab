// The file of a path, as a person has chosen it.
import { signal } from "@preact/signals";
import { call } from "./bench";
import { hexOf } from "./hex";
import { texts } from "./texts";

export interface PathFile {
  name: string;
  bytes: Uint8Array;
}

/** What a file is; "auto" is a table or G-code, as tmcld finds. */
export const kinds = ["auto", "gcode", "csv", "mint"] as const;
export type Kind = (typeof kinds)[number];

/** As path.stage takes them. */
export const mostBytes = 16_777_216;
const bytesAtOnce = 16_384;

export const file = signal<PathFile | null>(null);
export const kind = signal<Kind>("auto");

/** Empty, or why the file is not taken. Looks at its size before it reads it. */
export async function choose(chosen: File): Promise<string> {
  if (chosen.size > mostBytes) return texts.fileTooLarge(chosen.name, chosen.size, mostBytes);
  if (chosen.size === 0) return texts.fileEmpty(chosen.name);
  try {
    const bytes = new Uint8Array(await chosen.arrayBuffer());
    kind.value = /\.(mnt|mint)$/i.test(chosen.name) ? "mint" : "auto";
    file.value = { name: chosen.name, bytes };
    return "";
  } catch {
    return texts.fileUnreadable(chosen.name);
  }
}

/** Hands the file over; gives how many bytes tmcld has of it. */
export async function stage({ bytes }: PathFile): Promise<number> {
  for (let offset = 0; offset < bytes.length; offset += bytesAtOnce) {
    await call("path.stage", { offset, data: hexOf(bytes.subarray(offset, offset + bytesAtOnce)) });
  }
  return bytes.length;
}
