// Puts script and style into the page: it is one file, which any web server, mosquitto's too, or a folder can give.
import { createHash } from "node:crypto";

const hashOf = (text) => `'sha256-${createHash("sha256").update(text).digest("base64")}'`;

/** It loads nothing, and talks to brokers alone. */
const policyFor = (script, style) =>
  `default-src 'none'; script-src ${hashOf(script)}; style-src ${hashOf(style)}; img-src data:; connect-src ws: wss:; base-uri 'none'; form-action 'none'`;

export function oneFile() {
  return {
    name: "one_file",
    enforce: "post",
    generateBundle(_options, bundle) {
      const parts = Object.values(bundle);
      const page = parts.find(({ fileName }) => fileName.endsWith(".html"));
      const script = parts.find(({ type }) => type === "chunk").code.trim().replaceAll("</script", "<\\/script");
      const style = String(parts.find(({ fileName }) => fileName.endsWith(".css")).source).trim();
      for (const { fileName } of parts) if (fileName !== page.fileName) delete bundle[fileName];
      page.source = String(page.source)
        .replace(/\s*<(script|link)\b[^>]*\b(src|rel="stylesheet")[^>]*>(<\/script>)?/g, "")
        .replace("<head>", () => `<head>\n    <meta http-equiv="Content-Security-Policy" content="${policyFor(script, style)}" />`)
        .replace("</head>", () => `<style>${style}</style></head>`)
        .replace("</body>", () => `<script>${script}</script></body>`);
    },
  };
}
