import { useState } from "preact/hooks";
import { call } from "../bench";
import { textOf, type Answer } from "../rpc";
import { texts } from "../texts";
import { Table } from "./table";

type Finding = Answer<"doctor.examine">["findings"][number];

/** What tmcld finds wrong when it is asked, and what to try. */
export function Findings() {
  const [findings, setFindings] = useState<Finding[] | null>(null);
  const [isAsking, setAsking] = useState(false);
  const [problem, setProblem] = useState("");
  const examine = async () => {
    setAsking(true);
    setProblem("");
    await call("doctor.examine", {}).then(
      (answer) => setFindings(answer.findings),
      (error) => setProblem(textOf(error)),
    );
    setAsking(false);
  };
  return (
    <>
      <div class="row">
        <button disabled={isAsking} onClick={() => void examine()}>
          {texts.examine}
        </button>
        <span class="help">{texts.examineHelp}</span>
      </div>
      {problem && <p class="problem" role="alert">{problem}</p>}
      {findings && <Result findings={findings} />}
    </>
  );
}

function Result({ findings }: { findings: Finding[] }) {
  const wrong = findings.filter((one) => one.wrong);
  const shown = [...wrong, ...findings.filter((one) => !one.wrong)];
  return (
    <>
      <p role="status" class={wrong.length > 0 ? "problem" : "good"}>
        {texts.found(wrong.length, findings.length)}
      </p>
      <Table caption={texts.findings} heads={[texts.check, texts.subject, texts.finding, texts.cure]}>
        {shown.map((one) => (
          <tr class={one.wrong ? "problem" : ""}>
            <th scope="row">{one.check}</th>
            <td>{one.subject}</td>
            <td>{one.text}</td>
            <td>{one.cure ?? ""}</td>
          </tr>
        ))}
      </Table>
    </>
  );
}
