// How a page looks, against the pictures in docs/page; TMCL_DRAW=1 draws them anew. Fonts and how they are smoothed differ
// from computer to computer: the means of small blocks are compared, and some may be different.
import assert from "node:assert/strict";
import { mkdir, readFile, writeFile } from "node:fs/promises";
import { join } from "node:path";
import { open, until } from "./bench.mjs";

export const folder = process.env.TMCL_PICTURES;
const blockPixels = 8;
const sameLevels = 12; // of 255
export const mostDifferent = 0.005;

const blank = await open("about:blank");

/** Whether the font is there that the pictures were drawn with. */
const hasFont = () =>
  blank.evaluate(() => {
    const context = new OffscreenCanvas(1, 1).getContext("2d");
    context.font = "100px sans-serif";
    return Math.abs(context.measureText("mmmmmmmmmm").width - 974) < 2; // DejaVu Sans
  });
export const skip = (await hasFont()) ? false : "the pictures are of a computer whose usual font is DejaVu Sans (fonts-dejavu-core)";

/** Which share of the blocks of two pictures is different, but for places that are ignored. */
export const difference = (one, other, ignored) =>
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
export const look = async (page) => {
  await until("the page is laid out", async () => {
    const { width, height } = page.viewportSize();
    const needed = await page.evaluate(() => document.documentElement.scrollHeight);
    await page.setViewportSize({ width, height: needed });
    return height === needed;
  });
  return page.screenshot({ animations: "disabled", caret: "hide" });
};
/** `ignored`: what depends on when something was measured. */
export async function looksLike(page, name, ignored = []) {
  const picture = join(folder, `${name}.png`);
  if (process.env.TMCL_DRAW) {
    await mkdir(folder, { recursive: true });
    await writeFile(picture, await look(page));
  }
  const now = await look(page);
  const boxes = await Promise.all(ignored.map((locator) => locator.boundingBox()));
  const share = await difference(await readFile(picture), now, boxes);
  assert.ok(share < mostDifferent, `${(100 * share).toFixed(1)} % of ${picture} are different`);
}
