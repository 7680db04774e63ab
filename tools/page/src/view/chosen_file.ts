import { CallError } from "../rpc";
import { texts } from "../texts";

// tmcld ends a connection with a longer message, and with that what the page lets turn. A program is sent in twice its bytes.
const mostBytes = 30_000;

/** The file of a field, which then takes the same one again. */
export function chosenFile(field: HTMLInputElement): File | null {
  const file = field.files?.[0] ?? null;
  field.value = "";
  if (file && file.size > mostBytes) throw new CallError(texts.fileTooLong(file.name, mostBytes), "file_too_long");
  return file;
}
