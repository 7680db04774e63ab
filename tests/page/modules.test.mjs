// The part of the page about modules: faults, parameters, settings and programs.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { readFile, writeFile } from "node:fs/promises";
import { join } from "node:path";
import { after, afterEach, beforeEach, describe, it } from "node:test";
import { Bench, button, closeBrowser, open, seriousFindings, signIn, until } from "./bench.mjs";

let bench, page;
after(closeBrowser);
afterEach(async () => {
  assert.deepEqual(page.complaints, []);
  await page.context().close();
  await bench.end();
});

const row = (name) => page.locator(`[data-parameter=${name}]`);
const field = (name) => page.getByLabel(`Value of ${name}`);
const valueOf = async (parameter) => (await bench.call("parameter.get", { axis: "x", parameter })).value;
const part = (name) => page.getByRole("region", { name, exact: true });

async function set(name, text) {
  await field(name).fill(text);
  await button(row(name), "Set").click();
}

describe("the parameters of a module", () => {
  beforeEach(async () => {
    bench = await Bench.create();
    page = await open(`${bench.url}/?tab=modules`);
    await until("values", async () => (await field("max_current").inputValue()) !== "");
  });

  it("are shown with what they mean, and changed", async () => {
    const words = await row("max_current").textContent();
    assert.match(words, /0 \.\. 255/);
    assert.equal(Number(await field("max_current").inputValue()), await valueOf("max_current"));
    await set("max_current", "77");
    await row("max_current").getByRole("status").waitFor();
    assert.equal(await valueOf("max_current"), 77);
    await set("max_velocity", "5mm/s");
    await row("max_velocity").getByRole("status").waitFor();
    const { value_in_unit } = await bench.call("parameter.get", { axis: "x", parameter: "max_velocity" });
    assert.ok(Math.abs(value_in_unit - 5) < 0.1);
  });

  it("are refused at their field when they are out of range", async () => {
    const before = await valueOf("max_current");
    await set("max_current", "256");
    await row("max_current").getByRole("alert").getByText("256 is outside 0..255").waitFor();
    assert.equal(await field("max_current").getAttribute("aria-invalid"), "true");
    assert.equal(await page.getByRole("alert").count(), 1);
    assert.equal(await valueOf("max_current"), before);
    await set("max_current", "12");
    await row("max_current").getByRole("alert").waitFor({ state: "detached" });
  });

  it("are stored in the module", async () => {
    await set("max_current", "77");
    await row("max_current").getByText("Set", { exact: true }).last().waitFor();
    await button(page, "Store max_current").click();
    await row("max_current").getByText("Stored").waitFor();
    await bench.call("parameter.set", { axis: "x", parameter: "max_current", value: 5 });
    await bench.call("parameter.restore", { axis: "x", parameter: "max_current" });
    assert.equal(await valueOf("max_current"), 77);
  });

  it("are not offered to be changed when they can only be read, or move the motor", async () => {
    for (const name of ["actual_velocity", "target_position", "actual_position", "target_velocity"]) {
      await row(name).waitFor();
      assert.equal(await row(name).getByRole("textbox").count(), 0, name);
    }
    assert.equal(await button(page, "Store target_position").count(), 0);
  });

  it("are found by a filter", async () => {
    await page.getByRole("textbox", { name: "Filter", exact: true }).fill("standby");
    await row("actual_velocity").waitFor({ state: "detached" });
    await row("standby_current").waitFor();
  });

  it("are those of the axis that is chosen", async () => {
    await bench.call("parameter.set", { axis: "z", parameter: "max_current", value: 33 });
    await part("Modules").getByLabel("Axis").selectOption("z");
    await page.getByRole("table", { name: "Parameters of z" }).waitFor();
    await until("its value", async () => (await field("max_current").inputValue()) === "33");
  });
});

describe("the settings of a module", () => {
  beforeEach(async () => {
    bench = await Bench.create();
    page = await open(`${bench.url}/?tab=modules`);
  });

  it("are saved as a file, and compared with it", async () => {
    const [download] = await Promise.all([page.waitForEvent("download"), button(page, "Save settings").click()]);
    const file = join(bench.folder, "kept.toml");
    await writeFile(file, await readFile(await download.path()));
    const choose = () => page.getByLabel("Compare with a file").setInputFiles(file);
    await choose();
    await page.getByText("The module is as kept.toml says").waitFor();
    const before = await valueOf("max_current");
    await bench.call("parameter.set", { axis: "x", parameter: "max_current", value: before - 1 });
    await choose();
    const different = page.getByRole("table", { name: "What is different" }).locator("tbody tr");
    await different.first().waitFor();
    assert.deepEqual(await different.locator(":scope > *").allTextContents(), ["motor.0", "max_current", String(before - 1), String(before)]);
    await writeFile(file, "this is no file of settings");
    await choose();
    await part("Settings").getByRole("alert").waitFor();
    await writeFile(file, "#".repeat(100_000));
    await choose();
    await part("Settings").getByText(/kept.toml is too long/).waitFor();
  });
});

describe("the program of a module", () => {
  const program = () => part("Program");
  const state = (word) => program().locator(`[data-state=${word}]`).waitFor();
  const commands = () => page.getByRole("table", { name: "Program" }).locator("tbody tr");

  /** As tmclctl makes it of a text. */
  const load = async (text) => {
    const source = join(bench.folder, "program.tmc");
    const file = join(bench.folder, "program.bin");
    await writeFile(source, text);
    const { status, stderr } = spawnSync(join(process.env.TMCL_BIN, "tmclctl"), ["program", "assemble", source, "-o", file]);
    assert.equal(status, 0, String(stderr));
    await page.getByLabel("Load a program file").setInputFiles(file);
    await page.getByText(/program.bin is in the module/).waitFor();
  };
  beforeEach(async () => {
    bench = await Bench.create();
    page = await open(`${bench.url}/?tab=modules`);
  });

  it("is loaded, runs, and is stopped", async () => {
    await load("Loop: WAIT TICKS, 0, 10\nJA Loop\n");
    assert.deepEqual(await commands().getByRole("rowheader").allTextContents(), ["WAIT", "JA"]);
    await button(page, "Run program").click();
    await state("running");
    assert.equal((await bench.call("program.status", { bus: "bench", address: 1 })).state, "running");
    assert.ok(await button(page, "Step").isDisabled());
    await button(page, "Stop program").click();
    await state("stopped");
  });

  it("is executed command by command, and stops at a breakpoint", async () => {
    await load("SGP 1, 2, 5\nSGP 1, 2, 6\nSGP 1, 2, 7\nSTOP\n");
    const next = (address) => page.locator("[aria-current=step]").getByRole("cell", { name: String(address), exact: true }).first().waitFor();
    const variable = async () => (await bench.call("global.get", { bus: "bench", address: 1, bank: 2, parameter: 1 })).value;
    await button(page, "Reset program").click();
    await next(0);
    await button(page, "Step").click();
    await next(1);
    assert.equal(await variable(), 5);
    await button(page, "Breakpoint at 2").click();
    await page.getByRole("button", { name: "Breakpoint at 2", pressed: true }).waitFor();
    await button(page, "Run program").click();
    await next(2);
    assert.equal(await variable(), 6);
  });

  it("is read from the module", async () => {
    await load("SGP 1, 2, -5\nSTOP\n");
    await page.reload();
    await button(page, "Read program").click();
    await commands().getByRole("rowheader", { name: "STOP" }).waitFor();
    assert.deepEqual(await commands().first().getByRole("cell").allTextContents(), ["0", "1", "2", "-5", "–"]);
  });

  it("is refused with the reason when the file is none", async () => {
    const file = join(bench.folder, "none.bin");
    await writeFile(file, "12345");
    await page.getByLabel("Load a program file").setInputFiles(file);
    await program().getByRole("alert").waitFor();
    assert.equal(await commands().count(), 0);
  });
});

describe("the text of a program", () => {
  const html = '<img src="x" onerror="document.title = 1">';
  const editor = () => page.getByRole("textbox", { name: "Text of a program" });
  const problems = () => page.getByRole("list", { name: "What is wrong in the text" }).getByRole("listitem");
  const nextLine = (text) => page.locator(".editor .next").getByText(text, { exact: true }).waitFor();
  beforeEach(async () => {
    bench = await Bench.create();
    page = await open(`${bench.url}/?tab=modules`);
    await editor().waitFor();
  });

  it("is loaded into the module, and followed line by line", async () => {
    await editor().fill("// three values\nFirst = 5\nSGP 1, 2, First\nSGP 1, 2, 6\n\nEnd: SGP 1, 2, 7\nSTOP\n");
    await page.getByText("4 commands", { exact: true }).waitFor();
    await button(page, "Load the text").click();
    await page.getByText("The text is in the module: 4 commands").waitFor();
    const rows = page.getByRole("table", { name: "Program" }).locator("tbody tr");
    assert.deepEqual(await rows.locator("td:nth-of-type(5)").allTextContents(), ["3", "4", "6", "7"]);
    await button(page, "Reset program").click();
    await nextLine("SGP 1, 2, First");
    await button(page, "Step").click();
    await nextLine("SGP 1, 2, 6");
    await button(page, "Breakpoint at 2").click();
    await page.getByRole("button", { name: "Breakpoint at 2", pressed: true }).waitFor();
    await button(page, "Run program").click();
    await nextLine("End: SGP 1, 2, 7");
    assert.equal((await bench.call("global.get", { bus: "bench", address: 1, bank: 2, parameter: 1 })).value, 6);
    assert.equal(await page.locator(".editor .break").textContent(), "End: SGP 1, 2, 7\n");
    await editor().fill("STOP\n");
    await until("no line of another text is marked", async () => (await page.locator(".editor .next").count()) === 0);
  });

  it("lies over its coloured text, letter over letter", async () => {
    await editor().fill("SGP 1, 2, 5\n");
    const look = (place) =>
      place.evaluate((element) => {
        const { font, paddingTop, paddingLeft, tabSize, whiteSpace } = getComputedStyle(element);
        return { font, paddingTop, paddingLeft, tabSize, whiteSpace };
      });
    assert.deepEqual(await look(page.locator(".editor pre")), await look(editor()));
    assert.equal(await page.locator(".editor pre").evaluate((element) => getComputedStyle(element).backgroundColor), "rgba(0, 0, 0, 0)");
  });

  it("has a breakpoint where the number of a line is clicked", async () => {
    const clickLine = async (line) => {
      const { top, height } = await editor().evaluate((field) => ({
        top: parseFloat(getComputedStyle(field).paddingTop),
        height: parseFloat(getComputedStyle(field).lineHeight),
      }));
      await editor().click({ position: { x: 20, y: top + (line - 0.5) * height } });
    };
    const broken = () => page.locator(".editor .break").allTextContents();
    await editor().fill("// two values\nSGP 1, 2, 5\nSGP 1, 2, 6\nSTOP\n");
    await page.getByText("3 commands", { exact: true }).waitFor();
    await clickLine(3);
    assert.deepEqual(await broken(), [], "the module does not have the text");
    await button(page, "Load the text").click();
    await page.getByText("The text is in the module: 3 commands").waitFor();
    await clickLine(1);
    await clickLine(3);
    await until("one breakpoint", async () => (await broken()).join() === "SGP 1, 2, 6\n");
    await button(page, "Reset program").click();
    await button(page, "Run program").click();
    await nextLine("SGP 1, 2, 6");
    await page.getByRole("button", { name: "Breakpoint at 1", pressed: true }).waitFor();
    await clickLine(3);
    await until("no breakpoint", async () => (await broken()).length === 0);
  });

  it("has all its problems at their lines, and is not loaded then", async () => {
    await editor().fill("/* Größe */ SGP 1, 2, Nothing\nSTOP\n  JA Nowhere\n");
    await until("two problems", async () => (await problems().count()) === 2);
    assert.match(await problems().nth(1).textContent(), /^Line 3, column 6: /);
    assert.deepEqual(await page.locator(".editor .bad").allTextContents(), ["/* Größe */ SGP 1, 2, Nothing\n", "  JA Nowhere\n"]);
    assert.equal(await editor().getAttribute("aria-invalid"), "true");
    assert.ok(await button(page, "Load the text").isDisabled());
    await problems().nth(0).getByRole("button").press("Enter");
    // Its column counts bytes.
    assert.equal(await editor().evaluate((field) => field.value.slice(field.selectionStart, field.selectionStart + 7)), "Nothing");
    await editor().fill("SGP 1, 2, 5\nSTOP\n");
    await page.getByText("2 commands", { exact: true }).waitFor();
    assert.equal(await problems().count(), 0);
    assert.equal(await page.locator(".editor .bad").count(), 0);
  });

  it("knows the names of the parameters of the module, and reads no file", async () => {
    await editor().fill("#include TMCLParam.tmc\nSAP MaxCurrent, 0, 9\n");
    await page.getByText("1 command", { exact: true }).waitFor();
    await editor().fill('#include "/etc/passwd"\n');
    await problems().getByText(/tmcld reads no files/).waitFor();
  });

  it("takes spaces while all axes stand, and while one moves the space bar stops it", async () => {
    await editor().focus();
    await page.keyboard.type("MVP ABS, 0, 1");
    await until("a text with spaces", async () => (await editor().inputValue()) === "MVP ABS, 0, 1");
    await bench.slow("x");
    await bench.call("axis.move_to", { axis: "x", position: 150 });
    await bench.moves("x");
    // The page may hear of the movement a little later.
    let presses = 0;
    await until("it was stopped", async () => {
      await page.keyboard.press("Space");
      ++presses;
      return !(await bench.state("x")).moving;
    });
    assert.ok((await bench.state("x")).position < 149);
    assert.ok((await editor().inputValue()).length < "MVP ABS, 0, 1".length + presses, "what stops is not typed");
  });

  it("stays while another part is looked at, is opened and saved as a file", async () => {
    const file = join(bench.folder, "loop.tmc");
    await writeFile(file, "Loop:\r\n  JA Loop\r\n");
    await page.getByLabel("Open a text").setInputFiles(file);
    await page.getByText("1 command", { exact: true }).waitFor();
    await button(page, "Axes").click();
    await button(page, "Modules").click();
    assert.equal(await editor().inputValue(), "Loop:\n  JA Loop\n");
    const [download] = await Promise.all([page.waitForEvent("download"), button(page, "Save the text").click()]);
    assert.equal(String(await readFile(await download.path())), "Loop:\n  JA Loop\n");
    await editor().fill("STOP ".repeat(20_000));
    await page.getByText("The text is too long: 60000 bytes at most").waitFor();
  });

  it("is text, whatever it looks like", async () => {
    await editor().fill(`${html}\n/* ${html} */\n`);
    await until("a problem", async () => (await problems().count()) > 0);
    await page.locator(".editor pre").getByText(`/* ${html} */`).waitFor();
    assert.equal(await page.locator("img").count(), 0);
    assert.equal(await page.title(), "tmcld");
  });
});

describe("a module and its observers", () => {
  it("are told faults in words, and names as text", async () => {
    bench = await Bench.create();
    page = await open("about:blank");
    const html = '<img src="x" onerror="document.title = 1">';
    await page.routeWebSocket("**/ws", (socket) => {
      const tmcld = socket.connectToServer();
      tmcld.onMessage((text) =>
        socket.send(
          text
            .replace('"flags":[]', '"flags":["overtemperature","short_to_ground_b"]')
            .replace(/"meaning":"[^"]*"/g, `"meaning":${JSON.stringify(html)}`),
        ),
      );
    });
    await page.goto(`${bench.url}/?tab=modules`);
    await page.getByText("driver too hot, phase B shorted to ground").waitFor();
    await page.getByText(html).first().waitFor();
    assert.equal(await page.locator("img").count(), 0);
    assert.equal(await page.title(), "tmcld");
  });

  for (const [role, offered] of [
    ["observe", []],
    ["operate", ["Set", "Run program"]],
    ["configure", ["Set", "Run program", "Store max_current"]],
  ]) {
    it(`are offered by the role ${role} what it may do`, async () => {
      bench = await Bench.create({ keys: "" });
      page = await open(`${bench.url}/?tab=modules`);
      await signIn(page, await bench.token(role, "lab"));
      await row("max_current").waitFor();
      await button(page, "Read program").waitFor();
      for (const name of ["Set", "Run program", "Store max_current"]) {
        assert.equal((await button(page, name).count()) > 0, offered.includes(name), name);
      }
      const loads = role === "configure" ? 1 : 0;
      assert.equal(await page.getByLabel("Load a program file").count(), loads);
      assert.equal(await button(page, "Load the text").count(), loads);
    });
  }

  it("go on a phone, and by a screen reader", async () => {
    bench = await Bench.create();
    page = await open(`${bench.url}/?tab=modules`, { bypassCSP: true, viewport: { width: 360, height: 640 } });
    await page.getByRole("textbox", { name: "Filter", exact: true }).fill("max_current");
    await row("max_current").waitFor();
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 360);
    await button(page, "Read program").click();
    await page.getByRole("textbox", { name: "Text of a program" }).fill("// a comment\nLoop: MVP ABS, 0, 5\n  JA Nowhere\n");
    await page.getByRole("list", { name: "What is wrong in the text" }).waitFor();
    assert.deepEqual(await seriousFindings(page), []);
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 360);
  });
});
