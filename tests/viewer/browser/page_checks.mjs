// What must hold of the page whatever its size and state. Each function runs in the page and returns what is wrong, a line
// each; nothing is wrong where the list is empty.

/** Boxes: nothing cut, overprinted or out of reach, no drawing distorted. Looked at from the top of the page. */
export function layoutFaults() {
  scrollTo(0, 0);
  const faults = [];
  const root = document.scrollingElement;
  const name = (node) => {
    const element = node.nodeType === Node.TEXT_NODE ? node.parentElement : node;
    const words = (node.textContent ?? "").trim().replace(/\s+/g, " ").slice(0, 30);
    return `${element.tagName.toLowerCase()}${element.id ? `#${element.id}` : ""} "${words}"`;
  };
  const isShown = (element) => element.checkVisibility({ visibilityProperty: true, opacityProperty: true }) && !element.closest(".unseen");
  const ancestors = (element) => {
    const list = [];
    for (let at = element.parentElement; at; at = at.parentElement) list.push(at);
    return list;
  };
  const layerOf = (element) => [element, ...ancestors(element)].find((one) => getComputedStyle(one).position === "fixed") ?? null;
  const scrolls = (element) => {
    const { overflowX, overflowY } = getComputedStyle(element);
    return element !== root && element !== document.body && [overflowX, overflowY].some((way) => way === "auto" || way === "scroll");
  };
  const hides = (element) => /hidden|clip/.test(getComputedStyle(element).overflow) && element !== document.body && element !== root;
  const meet = (a, b, slack = 1) =>
    Math.min(a.right, b.right) - Math.max(a.left, b.left) > slack && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > slack;
  const within = (a, b, slack = 1) =>
    a.left >= b.left - slack && a.right <= b.right + slack && a.top >= b.top - slack && a.bottom <= b.bottom + slack;
  const windowBox = { left: 0, top: 0, right: innerWidth, bottom: innerHeight };

  if (root.scrollWidth > innerWidth) faults.push(`the page is ${root.scrollWidth} px wide in a window of ${innerWidth}`);

  // Lines of text and boxes of controls.
  const things = [];
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let node = walker.nextNode(); node; node = walker.nextNode()) {
    if (node.textContent.trim() === "" || !isShown(node.parentElement)) continue;
    const range = document.createRange();
    range.selectNodeContents(node);
    for (const box of range.getClientRects()) {
      if (box.width > 0.5 && box.height > 0.5) things.push({ node, element: node.parentElement, box, text: true });
    }
  }
  const controls = [...document.querySelectorAll("button, input, [tabindex='0']")].filter(isShown);
  for (const element of controls) things.push({ node: element, element, box: element.getBoundingClientRect(), text: false });
  if (things.length < 40) faults.push(`only ${things.length} texts and controls are shown`);

  const bars = [...document.querySelectorAll("body *")].filter((one) => isShown(one) && getComputedStyle(one).position === "fixed");
  const below = Math.max(0, ...bars.filter((bar) => bar.getBoundingClientRect().top > innerHeight / 2 && !bar.matches("[role=dialog]"))
    .map((bar) => innerHeight - bar.getBoundingClientRect().top));
  for (const thing of things) {
    thing.layer = layerOf(thing.element);
    thing.seen = thing.box;
    const around = thing.text ? [thing.element, ...ancestors(thing.element)] : ancestors(thing.element);
    const scroller = around.find(scrolls);
    const clip = around.find((one) => hides(one));
    if (clip && !within(thing.box, clip.getBoundingClientRect())) faults.push(`${name(thing.node)} is cut by ${name(clip)}`);
    if (scroller) {
      const frame = scroller.getBoundingClientRect();
      const inner = { left: frame.left - scroller.scrollLeft, top: frame.top - scroller.scrollTop };
      const whole = { ...inner, right: inner.left + scroller.scrollWidth + 2, bottom: inner.top + scroller.scrollHeight + 2 };
      if (!within(thing.box, whole)) faults.push(`${name(thing.node)} is out of reach in ${name(scroller)}`);
      if (!within(frame, windowBox) && layerOf(scroller)) faults.push(`${name(scroller)} is out of the window`);
      thing.seen = { left: Math.max(thing.box.left, frame.left), right: Math.min(thing.box.right, frame.right),
        top: Math.max(thing.box.top, frame.top), bottom: Math.min(thing.box.bottom, frame.bottom) };
    } else if (thing.layer) {
      if (!within(thing.box, windowBox)) faults.push(`${name(thing.node)} is out of the window`);
    } else if (!within(thing.box, { left: 0, top: 0, right: innerWidth, bottom: root.scrollHeight - below })) {
      faults.push(`${name(thing.node)} is out of reach`);
    }
    if (!thing.text && thing.element.scrollWidth > thing.element.clientWidth + 1 && thing.element.matches("button, input")) {
      faults.push(`${name(thing.node)} is wider than its button`);
    }
  }
  for (const element of new Set(things.filter(({ text }) => text).map((thing) => thing.element))) {
    const style = getComputedStyle(element);
    if (style.display !== "inline" && !scrolls(element) && style.overflowX !== "visible" && element.scrollWidth > element.clientWidth + 1) {
      faults.push(`${name(element)} is clipped`);
    }
  }

  // What is in a layer of its own covers what is below it, and that can be scrolled.
  for (let i = 0; i < things.length; ++i) {
    for (let k = i + 1; k < things.length; ++k) {
      const [a, b] = [things[i], things[k]];
      if (!a.text && !b.text && (a.element.matches(".turning") || b.element.matches(".turning"))) continue;
      if (a.element === b.element || a.element.contains(b.element) || b.element.contains(a.element)) continue;
      if (a.layer !== b.layer || (a.text !== b.text && (a.text ? b : a).element.matches(".turning"))) continue;
      if (meet(a.seen, b.seen)) faults.push(`${name(a.node)} and ${name(b.node)} overprint each other`);
    }
  }
  for (let i = 0; i < bars.length; ++i) {
    for (const other of [...bars.slice(i + 1), document.querySelector(".bar")]) {
      if (other.contains(bars[i]) || bars[i].contains(other) || getComputedStyle(other).position === "relative") continue;
      if (meet(bars[i].getBoundingClientRect(), other.getBoundingClientRect())) faults.push(`${name(bars[i])} covers ${name(other)}`);
    }
  }

  const stop = document.getElementById("stop");
  const box = stop.getBoundingClientRect();
  const corners = [[box.left + 4, box.top + 4], [box.right - 4, box.bottom - 4], [(box.left + box.right) / 2, (box.top + box.bottom) / 2]];
  if (!within(box, windowBox, 0) || corners.some(([x, y]) => !stop.contains(document.elementFromPoint(x, y)))) {
    faults.push("the stop button is not in sight");
  }

  for (const canvas of document.querySelectorAll("canvas")) {
    if (!isShown(canvas) || canvas.clientWidth < 2) continue;
    const [across, down] = [canvas.width / canvas.clientWidth, canvas.height / canvas.clientHeight];
    if (Math.abs(across / down - 1) > 0.03) {
      faults.push(`${name(canvas)} in ${name(canvas.parentElement)} is distorted: ${canvas.width} x ${canvas.height} on ${canvas.clientWidth} x ${canvas.clientHeight}`);
    }
    if (!within(canvas.getBoundingClientRect(), canvas.parentElement.getBoundingClientRect(), 2)) {
      faults.push(`${name(canvas)} sticks out of ${name(canvas.parentElement)}`);
    }
  }
  return faults;
}

/** WCAG 2.2, 1.4.3 and 1.4.11, level AA, from computed styles; of a gradient its worst colour. */
export function contrastFaults() {
  const faults = [];
  const parse = (text) => {
    const [r, g, b, a = 1] = text.match(/[\d.]+/g).map(Number);
    return { r, g, b, a };
  };
  const over = (top, ground) => ({
    r: top.r * top.a + ground.r * (1 - top.a), g: top.g * top.a + ground.g * (1 - top.a), b: top.b * top.a + ground.b * (1 - top.a), a: 1,
  });
  const luminance = ({ r, g, b }) => {
    const [x, y, z] = [r, g, b].map((c) => (c / 255 <= 0.04045 ? c / 255 / 12.92 : ((c / 255 + 0.055) / 1.055) ** 2.4));
    return 0.2126 * x + 0.7152 * y + 0.0722 * z;
  };
  const ratio = (one, other) => {
    const [a, b] = [luminance(one), luminance(other)].sort((x, y) => y - x);
    return (a + 0.05) / (b + 0.05);
  };
  /** The colours that may lie behind. */
  const grounds = (element) => {
    let behind = [{ r: 11, g: 14, b: 19, a: 1 }];
    const chain = [];
    for (let at = element; at; at = at.parentElement) chain.unshift(at);
    for (const one of chain) {
      const style = getComputedStyle(one);
      const color = parse(style.backgroundColor);
      if (color.a > 0) behind = behind.map((ground) => over(color, ground));
      const stops = style.backgroundImage.match(/rgba?\([^)]*\)/g);
      if (stops) behind = stops.flatMap((stop) => behind.map((ground) => over(parse(stop), ground)));
    }
    return behind;
  };
  const opacity = (element) => {
    let product = 1;
    for (let at = element; at; at = at.parentElement) product *= Number(getComputedStyle(at).opacity);
    return product;
  };
  const judge = (what, element, color, least, behind = grounds(element)) => {
    const seen = { ...color, a: color.a * opacity(element) };
    const worst = Math.min(...behind.map((ground) => ratio(over(seen, ground), ground)));
    if (!(worst >= least)) faults.push(`${what}: ${worst.toFixed(2)}, at least ${least}`);
  };
  const isShown = (element) => element.checkVisibility({ visibilityProperty: true }) && !element.closest(".unseen");

  let texts = 0;
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let node = walker.nextNode(); node; node = walker.nextNode()) {
    const element = node.parentElement;
    if (node.textContent.trim() === "" || !isShown(element)) continue;
    ++texts;
    const style = getComputedStyle(element);
    const size = parseFloat(style.fontSize);
    const large = size >= 24 || (size >= 18.66 && Number(style.fontWeight) >= 700);
    judge(`"${node.textContent.trim().slice(0, 30)}" in ${element.tagName.toLowerCase()}.${element.className}`, element, parse(style.color), large ? 3 : 4.5);
  }
  if (texts < 40) faults.push(`only ${texts} texts are shown`);
  for (const element of document.querySelectorAll("input, .link i, .legend i, #progress, .mark.warning")) {
    if (!isShown(element)) continue;
    const style = getComputedStyle(element);
    const border = parseFloat(style.borderTopWidth) > 0;
    judge(`${element.tagName.toLowerCase()}.${element.className}`, element, parse(border ? style.borderTopColor : style.backgroundColor), 3, grounds(element.parentElement));
  }
  // Which of a group is chosen must not be told by shades that look alike.
  for (const radio of document.querySelectorAll("[role=radio][aria-checked=true]")) {
    const shadow = getComputedStyle(radio).boxShadow.match(/rgba?\([^)]*\)/);
    if (!shadow) faults.push(`${radio.textContent}: nothing marks it as chosen`);
    else judge(`mark of ${radio.textContent}`, radio, parse(shadow[0]), 3);
  }
  return faults;
}
