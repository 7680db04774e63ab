// Makes the page: names with a hash of the content in assets/, and each file compressed beside itself, as tmcld serves it.
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { brotliCompressSync, gzipSync } from "node:zlib";
import { defineConfig } from "vite";
import { oneFile } from "./one_file.js";

const compressible = /\.(html|js|css|svg|webmanifest)$/;

function filesIn(folder) {
  return readdirSync(folder, { withFileTypes: true }).flatMap((entry) => {
    const path = join(folder, entry.name);
    return entry.isDirectory() ? filesIn(path) : [path];
  });
}

// Of all files together, compressed: also a slow network shows the page at once.
const mostBytes = 150_000;

function compressed() {
  let folder;
  return {
    name: "compressed",
    configResolved: (config) => {
      folder = config.build.outDir;
    },
    closeBundle() {
      let total = 0;
      for (const path of filesIn(folder).filter((one) => compressible.test(one))) {
        const plain = readFileSync(path);
        const gzip = gzipSync(plain, { level: 9 });
        const brotli = brotliCompressSync(plain);
        writeFileSync(`${path}.gz`, gzip);
        writeFileSync(`${path}.br`, brotli);
        total += gzip.length;
      }
      if (total > mostBytes) throw new Error(`the page has ${total} bytes, compressed; ${mostBytes} at most`);
      console.log(`compressed with gzip: ${(total / 1000).toFixed(1)} kB in all`);
    },
  };
}

// The page of a fleet is one file beside the others: `vite build --mode fleet`, after them.
const ofFleet = {
  emptyOutDir: false,
  cssCodeSplit: false,
  rollupOptions: { input: "fleet.html", output: { format: "iife", inlineDynamicImports: true } },
};

export default defineConfig(({ mode }) => ({
  esbuild: { jsx: "automatic", jsxImportSource: "preact" },
  publicDir: mode === "fleet" ? false : "public",
  build: {
    outDir: process.env.TMCL_PAGE_FOLDER,
    emptyOutDir: true,
    // The page may not load what is written into an address.
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    ...(mode === "fleet" ? ofFleet : {}),
  },
  plugins: [...(mode === "fleet" ? [oneFile()] : []), compressed()],
}));
