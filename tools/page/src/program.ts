// A program file: eight bytes for each command, in hexadecimal as tmcld takes it.
import { mnemonicOf } from "./tmcl";

export interface ProgramLine {
  address: number;
  mnemonic: string;
  type: number;
  motor: number;
  value: number;
}

export function linesOf(program: string): ProgramLine[] {
  const commands = program.match(/.{16}/g) ?? [];
  return commands.map((digits, address) => {
    const byte = (index: number) => parseInt(digits.slice(2 * index, 2 * index + 2), 16);
    return { address, mnemonic: mnemonicOf(byte(0)), type: byte(1), motor: byte(2), value: parseInt(digits.slice(6, 14), 16) | 0 };
  });
}
