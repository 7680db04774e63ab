// Names with wildcards: * for any characters, ? for one.

/** Whether all of the name fits; an empty pattern fits every name. Small and large letters are the same. */
export function fits(pattern: string, name: string): boolean {
  return pattern === "" || fitsFrom(pattern.toLowerCase(), name.toLowerCase());
}

// The last * takes one more character where it goes on wrong: no pattern takes more than pattern times name.
function fitsFrom(pattern: string, name: string): boolean {
  let [at, inName, star, taken] = [0, 0, -1, 0];
  while (inName < name.length) {
    if (pattern[at] === "*") [star, taken] = [at++, inName];
    else if (pattern[at] === "?" || pattern[at] === name[inName]) [at, inName] = [at + 1, inName + 1];
    else if (star >= 0) [at, inName] = [star + 1, ++taken];
    else return false;
  }
  return /^\**$/.test(pattern.slice(at));
}
