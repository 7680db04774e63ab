import { useEffect } from "preact/hooks";
import { may } from "../access";
import { file, kind } from "../path_file";
import { outcome, plan, problem } from "../path_job";
import { paths, watchPaths } from "../path_status";
import { texts } from "../texts";
import { MintForm } from "./mint_form";
import { PathDrawing } from "./path_drawing";
import { PathInSpace } from "./path_in_space";
import { PathFileForm } from "./path_file_form";
import { PathForm } from "./path_form";
import { PathSteering } from "./path_steering";
import { PathTables } from "./path_tables";

/** Files of paths: planned, drawn, passed. */
export function Paths() {
  useEffect(watchPaths, []);
  const mayPlan = may("path.plan");
  return (
    <section class="paths" aria-label={texts.tabs.paths}>
      {mayPlan ? <PathFileForm /> : <p class="help">{texts.mayNotRunPaths}</p>}
      {paths.value.map((path) => (
        <PathSteering key={path.axes.join()} path={path} />
      ))}
      {mayPlan && file.value && (kind.value === "mint" ? <MintForm /> : <PathForm />)}
      <Problems />
      {outcome.value && <p class="good" role="status">{outcome.value}</p>}
      {plan.value && kind.value !== "mint" && (
        <>
          <div class="drawings">
            <PathDrawing plan={plan.value} />
            <PathInSpace plan={plan.value} />
          </div>
          <PathTables plan={plan.value} />
        </>
      )}
    </section>
  );
}

const mostLines = 50;

function Problems() {
  const what = problem.value;
  if (!what) return null;
  return (
    <div class="problem" role="alert">
      <p>{what.text}</p>
      {what.lines.length > 0 && (
        <ul>
          {what.lines.slice(0, mostLines).map((one) => (
            <li>{texts.problemAt(one.line, one.column, one.message)}</li>
          ))}
        </ul>
      )}
      {what.lines.length > mostLines && <p>{texts.furtherProblems(what.lines.length - mostLines)}</p>}
    </div>
  );
}
