import { useState } from "preact/hooks";
import { addressWith, brokerAddress, isUser, readAddress } from "../../fleet/address";
import { connect } from "../../fleet/session";
import { texts } from "../../fleet/texts";

/** Asks for the broker, and as whom. */
export function SignIn({ why }: { why: string }) {
  const asked = readAddress(new URL(location.href));
  const [broker, setBroker] = useState(asked.broker);
  const [user, setUser] = useState(asked.user);
  const [password, setPassword] = useState("");
  const [problem, setProblem] = useState("");
  const submit = (event: Event) => {
    event.preventDefault();
    const address = brokerAddress(broker.trim());
    setProblem(!address ? texts.noAddress : isUser(user) ? "" : texts.noUser);
    if (!address || !isUser(user)) return;
    const page = new URL(location.href);
    history.replaceState(null, "", addressWith(page, { ...asked, broker: broker.trim(), user }));
    connect({ address: broker.trim(), user, password });
  };
  return (
    <form class="sign-in" onSubmit={submit}>
      <h1>{texts.title}</h1>
      <Field name={texts.address} help={texts.addressHelp} type="url" value={broker} onText={setBroker} />
      <Field name={texts.user} help={texts.userHelp} type="text" value={user} onText={setUser} />
      <Field name={texts.password} help={texts.passwordHelp(brokerAddress(broker.trim())?.host ?? "?")} type="password" value={password} onText={setPassword} />
      <button>{texts.signIn}</button>
      {(problem || why) && <p class="problem" role="alert">{problem || why}</p>}
      <p class="help">{texts.moves}</p>
    </form>
  );
}

interface FieldOf {
  name: string;
  help: string;
  type: string;
  value: string;
  onText: (text: string) => void;
}

function Field({ name, help, type, value, onText }: FieldOf) {
  return (
    <label>
      {name}
      <input type={type} aria-label={name} autocomplete="off" spellcheck={false} value={value} onInput={(event) => onText(event.currentTarget.value)} />
      <span class="help">{help}</span>
    </label>
  );
}
