import { useState } from "preact/hooks";
import { call } from "../bench";
import { textOf, type Answer } from "../rpc";
import { texts } from "../texts";
import { chosenFile } from "./chosen_file";
import { saveFile } from "./save_file";
import { Table } from "./table";

type Difference = Answer<"settings.compare">["differences"][number];

/** The settings of a module as a file: kept, and compared. */
export function Settings({ bus, address }: { bus: string; address: number }) {
  const [compared, setCompared] = useState<{ name: string; differences: Difference[] } | null>(null);
  const [problem, setProblem] = useState("");
  const [isBusy, setBusy] = useState(false);
  const carryOut = async (action: () => Promise<void>) => {
    setBusy(true);
    setProblem("");
    setCompared(null);
    await action().catch((error) => setProblem(textOf(error)));
    setBusy(false);
  };
  const save = async () => {
    const { toml } = await call("settings.read", { bus, address });
    saveFile(`${bus}-${address}.toml`, toml, "application/toml");
  };
  const compare = async (field: HTMLInputElement) => {
    const file = chosenFile(field);
    if (!file) return;
    const toml = await file.text();
    const { differences } = await call("settings.compare", { bus, address, toml });
    setCompared({ name: file.name, differences });
  };
  return (
    <section class="part" aria-label={texts.settings}>
      <h2>{texts.settings}</h2>
      <div class="row">
        <button disabled={isBusy} onClick={() => void carryOut(save)}>
          {texts.saveSettings}
        </button>
        <label>
          {texts.compareSettings}
          <input type="file" accept=".toml" disabled={isBusy} onChange={({ currentTarget }) => void carryOut(() => compare(currentTarget))} />
        </label>
      </div>
      {problem && <p class="problem" role="alert">{problem}</p>}
      {compared && <p role="status">{texts.compared(compared.name, compared.differences.length)}</p>}
      {compared && compared.differences.length > 0 && <Differences differences={compared.differences} />}
    </section>
  );
}

function Differences({ differences }: { differences: Difference[] }) {
  return (
    <Table caption={texts.differences} heads={[texts.section, texts.parameter, texts.inModule, texts.inFile]}>
      {differences.map((one) => (
        <tr>
          <td>{one.section}</td>
          <th scope="row">{one.parameter}</th>
          <td class="number">{one.present ?? texts.notKnown}</td>
          <td class="number">{one.wanted}</td>
        </tr>
      ))}
    </Table>
  );
}
