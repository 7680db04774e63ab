// The modules of the page of a fleet, for node: what decides there does no I/O.
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const names = ["address", "broker_link", "fleet", "glob", "messages", "packets", "rows", "stop_run", "topics", "wishes"];

/** `file`: of this folder; each test has its own. */
export async function fleetModules(file) {
  const folder = join(process.env.TMCL_ROOT, "tools/page/src/fleet");
  const contents = names.map((name) => `export * as ${name} from "./${name}";`).join("\n");
  const outfile = join(dirname(fileURLToPath(import.meta.url)), file);
  await build({ stdin: { contents, resolveDir: folder }, bundle: true, format: "esm", outfile, logLevel: "error" });
  return import(outfile);
}
