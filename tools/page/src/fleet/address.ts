// What the address of the page says: the broker, the user, and which gateways are shown. Never a password.
import { isLevel } from "./topics";

export interface Asked {
  /** Empty: it is not said. */
  broker: string;
  user: string;
  gateways: string;
}

/** A page that the broker itself serves talks to that one. */
const ownBroker = ({ protocol, host }: URL) => (host === "" ? "" : `${protocol === "https:" ? "wss" : "ws"}://${host}`);

export function readAddress(page: URL): Asked {
  const said = page.searchParams;
  return { broker: said.get("broker") || ownBroker(page), user: said.get("user") ?? "", gateways: said.get("gateways") ?? "" };
}

/** The same page with that in its address. */
export function addressWith(page: URL, { broker, user, gateways }: Asked): URL {
  const address = new URL(page);
  for (const [name, value] of Object.entries({ broker, user, gateways })) {
    if (value === "") address.searchParams.delete(name);
    else address.searchParams.set(name, value);
  }
  return address;
}

/** Null for what is no address of a broker's WebSocket. */
export function brokerAddress(text: string): URL | null {
  const address = urlOf(text);
  const isPlain = address?.username === "" && address.password === "" && address.hash === "";
  return isPlain && ["ws:", "wss:"].includes(address.protocol) ? address : null;
}

function urlOf(text: string): URL | null {
  try {
    return new URL(text);
  } catch {
    return null;
  }
}

export const isUser = isLevel;
