import { useEffect, useRef } from "preact/hooks";
import { recording } from "../profile_recording";
import { simulations } from "../profiles";

/** Position, velocity and acceleration; what draws is loaded when it is wanted. */
export function ProfilePlots() {
  const place = useRef<HTMLDivElement>(null);
  const shown = simulations.value;
  const recorded = recording.value;
  useEffect(() => {
    let end = () => {};
    let isGone = false;
    void import("./profile_plot").then(({ drawProfiles }) => {
      if (!isGone) end = drawProfiles(place.current!, shown, recorded);
    });
    return () => {
      isGone = true;
      end();
    };
  }, [shown, recorded]);
  return <div class="plot" ref={place} />;
}
