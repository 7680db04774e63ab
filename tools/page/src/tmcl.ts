// What the bytes of a datagram of TMCL mean, in short.
import { texts } from "./texts";

/** Mnemonics by number, from the first one of each row on. */
const rows: [number, string][] = [
  [1, "ROR ROL MST MVP SAP GAP STAP RSAP SGP GGP STGP RSGP RFS SIO GIO"],
  [19, "CALC COMP JC JA CSUB RSUB EI DI WAIT STOP SAC SCO GCO CCO CALCX AAP AGP CLE VECT RETI ACO"],
  [40, "CALCVV CALCVA CALCAV CALCVX CALCXV CALCV MVPA"],
  [48, "RST DJNZ ROLA RORA"],
  [55, "SIV GIV AIV"],
  [64, "UF0 UF1 UF2 UF3 UF4 UF5 UF6 UF7"],
  [80, "CALL"],
  [128, "STOP_APPLICATION RUN_APPLICATION STEP_APPLICATION RESET_APPLICATION START_DOWNLOAD END_DOWNLOAD"],
  [134, "READ_TMCL_MEMORY GET_APPLICATION_STATUS GET_FIRMWARE_VERSION FACTORY_RESET TARGET_REACHED_EVENT"],
  [139, "ENTER_ASCII_MODE SECURITY_CODE BREAKPOINT RAM_DEBUG GET_IDS WRITE_USER_CHANNEL READ_USER_CHANNEL"],
  [146, "WRITE_MC WRITE_DRV READ_MC READ_DRV MEASURED_SPEED BOARD_ERROR BOARD_RESET"],
  [157, "GET_INFO"],
  [170, "GET_AP_MIN GET_AP_MAX OTP"],
  [242, "ENTER_BOOTLOADER"],
  [255, "SOFTWARE_RESET"],
];
const mnemonics = new Map(rows.flatMap(([first, words]) => words.split(" ").map((word, index) => [first + index, word] as const)));

export function mnemonicOf(command: number): string {
  return mnemonics.get(command) ?? String(command);
}

export interface Datagram {
  direction: string;
  bytes: string;
  can_id: number | null;
  garbage: boolean | null;
}

/** Of a whole datagram; empty for anything else. On CAN the identifier stands for the address, and there is no checksum. */
export function meaningOf({ direction, bytes, can_id, garbage }: Datagram): string {
  const parts = (bytes.match(/../g) ?? []).map((digits) => parseInt(digits, 16));
  const onCan = can_id != null;
  if (garbage) return texts.garbage;
  if (parts.length !== (onCan ? 7 : 9)) return "";
  const fields = onCan ? [can_id, ...parts] : parts;
  return direction === "out" ? commandText(fields) : replyText(fields);
}

function commandText([address, command, type, motor, ...value]: number[]): string {
  return `${mnemonicOf(command!)} ${type}, ${motor}, ${valueOf(value)} → ${address}`;
}

function replyText([, address, status, command, ...value]: number[]): string {
  return `${mnemonicOf(command!)} = ${valueOf(value)}, ${texts.statuses[status!] ?? texts.status(status!)} ← ${address}`;
}

function valueOf([first, second, third, fourth]: number[]): number {
  return (first! << 24) | (second! << 16) | (third! << 8) | fourth!;
}
