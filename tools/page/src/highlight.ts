// Which parts of a program's text are what, line by line, to colour them.

export type Kind = "" | "comment" | "label" | "command" | "word" | "number" | "text";
export type Part = [Kind, string];

const commands = new Set(
  (
    "AAP ACO AGP AIV CALC CALCAV CALCV CALCVA CALCVV CALCVX CALCX CALCXV CALL CCO CLE COMP CSUB DI DJNZ EI GAP GCO GGP GIO GIV JA JC " +
    "MST MVP MVPA RETI RFS ROL ROLA ROR RORA RSAP RSGP RST RSUB SAC SAP SCO SGP SIO SIV STAP STGP STOP UF0 UF1 UF2 UF3 UF4 UF5 UF6 " +
    "UF7 VECT WAIT .RAW #INCLUDE"
  ).split(" "),
);
const words = new Set(
  "ABS ADD ALL AND COMP COORD DIV EAL EDV EPO EQ ESD ETO GE GT LE LIMSW LOAD LT MOD MUL NE NOT NZ OR POS REFSW REL RELCOORD RFS START STATUS STOP SUB SWAP TICKS XOR ZE".split(" "),
);

// The first that fits; a comment may go on beyond its line.
const tokens = /\/\/.*|\/\*.*?(?:\*\/|$)|"[^"]*"?|[.#]?[A-Za-z_]\w*(?:\s*:)?|\$[0-9A-Fa-f]+|%[01]+|\d\w*|\s+|./g;

/** `isComment`: the line begins within one; told for the next line as well. */
export function partsOf(line: string, isComment: boolean): { parts: Part[]; isComment: boolean } {
  const parts: Part[] = [];
  let rest = line;
  if (isComment) {
    const end = line.indexOf("*/");
    if (end < 0) return { parts: [["comment", line]], isComment };
    parts.push(["comment", line.slice(0, end + 2)]);
    rest = line.slice(end + 2);
  }
  isComment = false;
  let hasCommand = false;
  for (const [token] of rest.matchAll(tokens)) {
    const kind = kindOf(token, hasCommand);
    hasCommand ||= kind === "command";
    isComment = token.startsWith("/*") && !(token.length > 3 && token.endsWith("*/"));
    parts.push([kind, token]);
  }
  return { parts, isComment };
}

/** STOP, COMP and RFS are commands, and words behind one. */
function kindOf(token: string, hasCommand: boolean): Kind {
  if (token.startsWith("//") || token.startsWith("/*")) return "comment";
  if (token.startsWith('"')) return "text";
  if (/^[\d$%]./.test(token) || /^\d$/.test(token)) return "number";
  if (token.length > 1 && token.endsWith(":")) return "label";
  const upper = token.toUpperCase();
  if (!hasCommand && commands.has(upper)) return "command";
  return words.has(upper) ? "word" : "";
}

/** Of every line. */
export function highlighted(text: string): Part[][] {
  let isComment = false;
  return text.split("\n").map((line) => {
    const told = partsOf(line, isComment);
    isComment = told.isComment;
    return told.parts;
  });
}
