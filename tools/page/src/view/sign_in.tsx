import { useState } from "preact/hooks";
import { signIn } from "../access";
import { texts } from "../texts";

export function SignIn({ why }: { why: string }) {
  const [token, setToken] = useState("");
  const [problem, setProblem] = useState<string | null>(null);
  const submit = async (event: Event) => {
    event.preventDefault();
    setProblem(await signIn(token.trim()));
  };
  return (
    <form class="sign-in" onSubmit={submit}>
      <h1>{texts.title}</h1>
      <label>
        {texts.token}
        <input type="password" autocomplete="off" value={token} onInput={(event) => setToken(event.currentTarget.value)} />
      </label>
      <button>{texts.signIn}</button>
      <p class="help">{texts.tokenHelp}</p>
      {(problem ?? why) && <p class="problem" role="alert">{problem ?? why}</p>}
    </form>
  );
}
