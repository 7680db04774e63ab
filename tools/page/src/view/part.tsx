import type { ComponentType } from "preact";
import { useEffect, useState } from "preact/hooks";
import type { Tab } from "../tabs";
import { texts } from "../texts";

/** What is not of the axes is loaded when it is wanted: it is not needed to stop them. */
const loaders: Record<Exclude<Tab, "axes">, () => Promise<ComponentType>> = {
  paths: () => import("./paths").then((part) => part.Paths),
  profiles: () => import("./profiles").then((part) => part.Profiles),
  modules: () => import("./modules").then((part) => part.Modules),
  bus: () => import("./bus").then((part) => part.Bus),
};

export function Part({ tab }: { tab: Exclude<Tab, "axes"> }) {
  const [Shown, setShown] = useState<ComponentType | null>(null);
  const [isMissing, setMissing] = useState(false);
  useEffect(() => {
    loaders[tab]().then((part) => setShown(() => part), () => setMissing(true));
  }, [tab]);
  if (isMissing) return <p class="problem" role="alert">{texts.partMissing}</p>;
  return Shown && <Shown />;
}
