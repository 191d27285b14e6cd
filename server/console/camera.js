// camera.js -- what has to be known of the camera of a depth image, which such a file does not say.

import { el } from "./dom.js";
import { field } from "./widgets.js";

const FIELDS = [["fx", "Focal length, x", "pixels"], ["fy", "Focal length, y", "pixels"], ["cx", "Centre, x", "pixels"], ["cy", "Centre, y", "pixels"],
  ["depth_scale", "Depth of 1", "mm, or steps in a metre"]];
const HEADS = ["\x89PNG", "\x93NUM"];

/** Fields that show once a file is a depth image.  ready(files): may they be sent?  values: for the query.
 *  changed(): they may be sent now. */
export function camera(changed) {
  const inputs = FIELDS.map(([name]) => el("input", { type: "number", step: "any", min: name[0] === "c" ? null : 0, required: name !== "depth_scale", onchange: () => whole() && changed() }));
  const whole = () => inputs.every((i) => i.validity.valid); // a fieldset is always valid
  const element = el("fieldset.camera", { hidden: true }, el("legend", {}, "The camera of the depth image"),
    FIELDS.map(([, title, note], i) => field(title, inputs[i], note)));

  async function ready(files) {
    const heads = await Promise.all([...files].map(async (f) => String.fromCharCode(...new Uint8Array(await f.slice(0, 4).arrayBuffer()))));
    element.hidden = !heads.some((head) => HEADS.includes(head));
    element.disabled = element.hidden;
    const ok = element.hidden || whole();
    if (!ok) inputs.find((i) => !i.validity.valid).focus();
    return ok;
  }

  return { element, ready, get values() { return element.hidden ? {} : Object.fromEntries(inputs.map((i, k) => [FIELDS[k][0], i.value])); } };
}
