// How the page looks, against the pictures in docs/page; TMCL_DRAW=1 draws them anew. Fonts and how they are smoothed differ
// from computer to computer: the means of small blocks are compared, and some may be different.
import assert from "node:assert/strict";
import { mkdir, readFile, writeFile } from "node:fs/promises";
import { join } from "node:path";
import { after, afterEach, beforeEach, describe, it } from "node:test";
import { Bench, button, card, closeBrowser, open, until } from "./bench.mjs";

const folder = process.env.TMCL_PICTURES;
const blockPixels = 8;
const sameLevels = 12; // of 255
const mostDifferent = 0.005;

const part = "G21 G90\nF1200\nG1 X10 Y0\nG2 X0 Y10 I-10 J0\nG1 X10 Y10\nG2 X10 Y0 I0 J-5\nM2\n";

let bench, page;
const blank = await open("about:blank");
after(closeBrowser);
afterEach(async () => {
  await page.context().close();
  await bench.end();
});

/** Whether the font is there that the pictures were drawn with. */
const hasFont = () =>
  blank.evaluate(() => {
    const context = new OffscreenCanvas(1, 1).getContext("2d");
    context.font = "100px sans-serif";
    return Math.abs(context.measureText("mmmmmmmmmm").width - 974) < 2; // DejaVu Sans
  });
const skip = (await hasFont()) ? false : "the pictures are of a computer whose usual font is DejaVu Sans (fonts-dejavu-core)";

/** Which share of the blocks of two pictures is different, but for places that are ignored. */
const difference = (one, other, ignored) =>
  blank.evaluate(
    async ([one, other, ignored, blockPixels, sameLevels]) => {
      const decode = async (base64) => createImageBitmap(await (await fetch(`data:image/png;base64,${base64}`)).blob());
      const images = await Promise.all([one, other].map(decode));
      const [width, height] = ["width", "height"].map((side) => Math.max(...images.map((image) => image[side])));
      if (images.some((image) => Math.abs(image.height - height) > blockPixels || image.width !== width)) return 1;
      const means = images.map((image) => {
        const canvas = new OffscreenCanvas(Math.ceil(width / blockPixels), Math.ceil(height / blockPixels));
        const context = canvas.getContext("2d");
        context.imageSmoothingQuality = "high";
        context.drawImage(image, 0, 0, canvas.width, canvas.height);
        return context.getImageData(0, 0, canvas.width, canvas.height);
      });
      let [different, all] = [0, 0];
      for (let block = 0; block < means[0].width * means[0].height; ++block) {
        const [x, y] = [block % means[0].width, Math.floor(block / means[0].width)].map((place) => (place + 0.5) * blockPixels);
        if (ignored.some((box) => x >= box.x && x <= box.x + box.width && y >= box.y && y <= box.y + box.height)) continue;
        ++all;
        if ([0, 1, 2].some((colour) => Math.abs(means[0].data[4 * block + colour] - means[1].data[4 * block + colour]) > sameLevels)) ++different;
      }
      return different / all;
    },
    [one.toString("base64"), other.toString("base64"), ignored, blockPixels, sameLevels],
  );

/** All of the page: what is always in sight would be drawn in the middle of a page that is scrolled. */
const look = async () => {
  await until("the page is laid out", async () => {
    const { width, height } = page.viewportSize();
    const needed = await page.evaluate(() => document.documentElement.scrollHeight);
    await page.setViewportSize({ width, height: needed });
    return height === needed;
  });
  return page.screenshot({ animations: "disabled", caret: "hide" });
};
/** `ignored`: what depends on when something was measured. */
async function looksLike(name, ignored = []) {
  const picture = join(folder, `${name}.png`);
  if (process.env.TMCL_DRAW) {
    await mkdir(folder, { recursive: true });
    await writeFile(picture, await look());
  }
  const now = await look();
  const boxes = await Promise.all(ignored.map((locator) => locator.boundingBox()));
  const share = await difference(await readFile(picture), now, boxes);
  assert.ok(share < mostDifferent, `${(100 * share).toFixed(1)} % of ${picture} are different`);
}

describe("the page looks as it did", { skip }, () => {
  beforeEach(async () => {
    bench = await Bench.create();
  });
  const show = async (query = "", options = {}) => {
    page = await open(`${bench.url}/${query}`, { viewport: { width: 1280, height: 800 }, ...options });
    await button(page, "Stop all").waitFor();
  };
  const goTo = async (positions) => {
    for (const [name, position] of Object.entries(positions)) {
      await bench.call("axis.move_to", { axis: name, position });
      await bench.stands(name);
      const shown = () => card(page, name).textContent();
      await until(`${name} is shown there`, async () => (await shown()).includes(`${position} mm`) && (await shown()).includes("stands"));
    }
  };

  it("with axes and a scope", async () => {
    await show();
    for (const value of ["position", "velocity"]) {
      await page.getByRole("region", { name: "Scope" }).getByLabel("Value").fill(value);
      await button(page, "Add").click();
    }
    await page.locator(".plot canvas").first().waitFor();
    await goTo({ y: -60, z: 7.5 });
    await until("a move that was foreseen", async () => {
      await goTo({ x: 0 });
      await goTo({ x: 20 });
      return (await page.locator(".plot .uplot").count()) > 1;
    });
    await button(page, "Pause").click();
    const plot = page.locator(".plot");
    await looksLike("axes", [plot]);
    // A card that is missing makes the comparison fail.
    await card(page, "y").evaluate((element) => (element.style.visibility = "hidden"));
    const share = await difference(await readFile(join(folder, "axes.png")), await look(), [await plot.boundingBox()]);
    assert.ok(share > mostDifferent, `a card that is gone is ${share} of the blocks`);
  });

  it("in the dark, with a module that has started again", async () => {
    await show("", { colorScheme: "dark" });
    await goTo({ x: 20, y: -60 });
    await bench.call("module.reset", { bus: "bench", address: 1 });
    for (const name of ["x", "y", "z"]) await until(`${name} may be recovered`, () => button(card(page, name), "Recover").isEnabled());
    await looksLike("dark");
  });

  it("on a phone", async () => {
    await show("", { viewport: { width: 360, height: 640 } });
    await goTo({ x: 20 });
    await looksLike("phone");
  });

  it("with a path", async () => {
    await show("?tab=paths");
    await page.getByLabel("Path file").setInputFiles({ name: "part.ngc", mimeType: "text/plain", buffer: Buffer.from(part) });
    await until("it may be run", () => button(page, "Run").isEnabled());
    await page.getByText("Expected in each mode").waitFor();
    // A bus that was measured as slow brings warnings, which move the tables down.
    const warnings = page.locator(".paths p.problem");
    await warnings.evaluateAll((all) => all.forEach((one) => (one.style.display = "none")));
    await looksLike("paths", [page.getByRole("table").last()]);
  });

  it("with the ramps of four chips", async () => {
    await show("?tab=profiles");
    await until("all are computed", async () => {
      const times = await page.getByRole("row", { name: /^Time of the move/ }).getByRole("cell").allTextContents();
      return times.length >= 4 && times.every((time) => Number(time) > 0);
    });
    await looksLike("profiles");
  });
});

it("looks as it did before a sign-in", { skip }, async () => {
  bench = await Bench.create({ keys: "" });
  page = await open(bench.url, { viewport: { width: 1280, height: 400 } });
  await page.getByLabel("Token").waitFor();
  await looksLike("sign-in");
});
