// Modules of the pages, for node: what decides there does no I/O.
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const names = ["address", "broker_link", "fleet", "glob", "messages", "packets", "rows", "stop_run", "topics", "wishes"];

/** `file`: of this folder; each test has its own. */
export function fleetModules(file) {
  const contents = names.map((name) => `export * as ${name} from "./${name}";`).join("\n");
  return bundled(contents, "tools/page/src/fleet", file, []);
}

/** What a page foresees; `globalThis.callOfPage` answers instead of tmcld. */
export function forecastModule(file) {
  const standIns = {
    "./bench": "export const call = (...words) => globalThis.callOfPage(...words);",
    "@preact/signals": "export const signal = (value) => ({ value, peek: () => value });",
  };
  const plugin = {
    name: "stand-ins",
    setup(one) {
      one.onResolve({ filter: /./ }, ({ path }) => (path in standIns ? { path, namespace: "stand-ins" } : undefined));
      one.onLoad({ filter: /./, namespace: "stand-ins" }, ({ path }) => ({ contents: standIns[path] }));
    },
  };
  return bundled('export * from "./forecast";', "tools/page/src", file, [plugin]);
}

async function bundled(contents, folder, file, plugins) {
  const outfile = join(dirname(fileURLToPath(import.meta.url)), file);
  const stdin = { contents, resolveDir: join(process.env.TMCL_ROOT, folder) };
  await build({ stdin, bundle: true, format: "esm", outfile, logLevel: "error", plugins });
  return import(outfile);
}
