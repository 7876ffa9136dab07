"use strict";
(() => {
  const states = JSON.parse(document.getElementById("states").textContent);
  const main = document.querySelector("main");
  const rows = [...document.querySelectorAll("[role=treeitem]")];
  const steps = [...document.querySelectorAll("[role=option]")];
  const byId = (id) => document.getElementById(id);
  const level = (row) => Number(row.getAttribute("aria-level"));
  const element = (tag, text, name) => {
    const made = document.createElement(tag);
    if (text !== undefined) made.textContent = text;
    if (name) made.className = name;
    return made;
  };

  // --------------------------------------------------------------------------------------- states

  const isListed = (value) => value !== "False" && value !== "unset";

  /** The values of all cells after an item of the trace; -1 is the initial state. */
  function stateAfter(item) {
    const values = new Map(states.initial);
    for (let i = 0; i <= item; i++) {
      for (const [cell, , after] of states.changes[i]) {
        if (isListed(after)) values.set(cell, after);
        else values.delete(cell);
      }
    }
    return values;
  }

  /** The cells that differ between two items, with the values before and after. */
  function changedWithin(from, to) {
    const changed = new Map();
    for (let i = from; i <= to; i++) {
      for (const [cell, before, after] of states.changes[i]) {
        const first = changed.has(cell) ? changed.get(cell)[0] : before;
        changed.set(cell, [first, after]);
      }
    }
    for (const [cell, [before, after]] of changed) if (before === after) changed.delete(cell);
    return changed;
  }

  let current = { values: new Map(), changed: new Map() };

  function listChanges(changed) {
    const list = byId("changed");
    list.replaceChildren();
    for (const [cell, [before, after]] of changed) {
      const row = element("li");
      const code = element("code", states.cells[cell] + ": ");
      code.append(element("span", before, "old"), " → " + after);
      row.append(code);
      list.append(row);
    }
    if (!changed.size) list.append(element("span", "Nothing.", "quiet"));
  }

  function listCells() {
    const wanted = byId("filter").value.toLowerCase();
    const { values, changed } = current;
    const all = [...new Set([...values.keys(), ...changed.keys()])].sort((a, b) => a - b);
    const groups = new Map();
    let left = 0;
    for (const cell of all) {
      const name = states.cells[cell];
      if (wanted && !name.toLowerCase().includes(wanted)) continue;
      if (++left > 2000) continue;
      const feature = name.slice(0, name.indexOf("("));
      if (!groups.has(feature)) groups.set(feature, element("ul"));
      const value = values.get(cell);
      const text = value === undefined || value === "True" ? name : name + " = " + value;
      const row = element("li", undefined, changed.has(cell) ? "changed" : "");
      if (value === undefined) row.classList.add("gone");
      row.append(element("code", text));
      groups.get(feature).append(row);
    }
    const box = byId("cells");
    box.replaceChildren(...groups.values());
    const hidden = states.leftOut + Math.max(0, left - 2000);
    if (hidden) box.append(element("p", `${hidden} more cells are not shown`, "quiet"));
  }

  /** Show the state after a stretch of the trace, and where that stands in the program. */
  function show(row, title) {
    const has = row.dataset.to !== undefined;
    const from = has ? Number(row.dataset.from) : 0;
    const to = has ? Number(row.dataset.to) : -1;
    current = { values: stateAfter(to), changed: changedWithin(from, to) };
    byId("where").textContent = has ? title : "Before anything was done";
    const source = (row.dataset.node ? byId("n" + row.dataset.node) : row).dataset.source;
    byId("place").replaceChildren(...(source ? [element("pre", source)] : []));
    listChanges(current.changed);
    listCells();
  }

  // ------------------------------------------------------------------------------------ selection

  /** Scroll the panel of a row, and not the page. */
  function bringIntoView(row) {
    const panel = row.closest("section");
    const own = row.getBoundingClientRect(), around = panel.getBoundingClientRect();
    if (own.top < around.top) panel.scrollTop += own.top - around.top - 8;
    else if (own.bottom > around.bottom) panel.scrollTop += own.bottom - around.bottom + 8;
  }

  function mark(list, chosen) {
    for (const other of list) {
      const is = other === chosen;
      other.setAttribute("aria-selected", is);
      other.tabIndex = is ? 0 : -1;
    }
    if (chosen) bringIntoView(chosen);
  }

  function chooseRow(row, focus) {
    reveal(row);
    mark(rows, row);
    const from = Number(row.dataset.from), to = Number(row.dataset.to);
    mark(steps, steps.find((s) => from === to && Number(s.dataset.from) === from) || null);
    if (!steps.some((s) => s.tabIndex === 0) && steps.length) steps[0].tabIndex = 0;
    const kind = row.querySelector(".kind").textContent;
    const title = `${kind} ${row.querySelector("code").textContent}`;
    show(row, row.classList.contains("failed") ? `Where it failed: ${title}` : `After ${title}`);
    if (focus) row.focus({ preventScroll: true });
  }

  function chooseStep(step, focus) {
    mark(steps, step);
    const row = byId("n" + step.dataset.node);
    reveal(row);
    mark(rows, row);
    show(step, `After step ${steps.indexOf(step) + 1}, ${step.querySelector("code").textContent}`);
    if (focus) step.focus({ preventScroll: true });
  }

  // ----------------------------------------------------------------------------------------- tree

  /** Hide what is under something closed. */
  function layOut() {
    let closed = Infinity;
    for (const row of rows) {
      if (level(row) <= closed) closed = Infinity;
      row.hidden = closed !== Infinity;
      if (!row.hidden && row.getAttribute("aria-expanded") === "false") closed = level(row);
    }
  }

  function above(row) {
    for (let i = rows.indexOf(row) - 1; i >= 0; i--) if (level(rows[i]) < level(row)) return rows[i];
    return null;
  }

  function reveal(row) {
    let changed = false;
    for (let up = above(row); up; up = above(up)) {
      if (up.getAttribute("aria-expanded") === "false") {
        up.setAttribute("aria-expanded", "true");
        changed = true;
      }
    }
    if (changed) layOut();
  }

  function expand(row, is) {
    row.setAttribute("aria-expanded", is);
    layOut();
  }

  function foldAll(is) {
    for (const row of rows) {
      if (row.hasAttribute("aria-expanded")) {
        row.setAttribute("aria-expanded", is || level(row) === 1);
      }
    }
    layOut();
  }

  const visible = (row) => !row.hidden && row.offsetParent !== null;

  function next(list, row, by) {
    for (let i = list.indexOf(row) + by; i >= 0 && i < list.length; i += by) {
      if (visible(list[i])) return list[i];
    }
    return row;
  }

  function onTreeKey(event) {
    const row = event.target.closest("[role=treeitem]");
    const state = row.getAttribute("aria-expanded");
    switch (event.key) {
      case "ArrowDown": chooseRow(next(rows, row, 1), true); break;
      case "ArrowUp": chooseRow(next(rows, row, -1), true); break;
      case "ArrowRight":
        if (state === "false") expand(row, true);
        else if (state === "true") chooseRow(next(rows, row, 1), true);
        break;
      case "ArrowLeft":
        if (state === "true") expand(row, false);
        else chooseRow(above(row) || row, true);
        break;
      case "Enter": case " ": if (state) expand(row, state === "false"); break;
      case "Home": chooseRow(rows[0], true); break;
      case "End": chooseRow(rows.filter(visible).pop(), true); break;
      default: return;
    }
    event.preventDefault();
  }

  function onStepKey(event) {
    const step = event.target.closest("[role=option]");
    switch (event.key) {
      case "ArrowDown": chooseStep(next(steps, step, 1), true); break;
      case "ArrowUp": chooseStep(next(steps, step, -1), true); break;
      case "Home": chooseStep(steps[0], true); break;
      case "End": chooseStep(steps[steps.length - 1], true); break;
      case "Enter": case " ": chooseStep(step, true); break;
      default: return;
    }
    event.preventDefault();
  }

  for (const tree of document.querySelectorAll("[role=tree]")) {
    tree.addEventListener("keydown", onTreeKey);
    tree.addEventListener("click", (event) => {
      const row = event.target.closest("[role=treeitem]");
      if (!row) return;
      if (event.target.classList.contains("mark") && row.hasAttribute("aria-expanded")) {
        expand(row, row.getAttribute("aria-expanded") === "false");
      }
      chooseRow(row, true);
    });
  }
  for (const list of document.querySelectorAll("[role=listbox]")) {
    list.addEventListener("keydown", onStepKey);
    list.addEventListener("click", (event) => {
      const step = event.target.closest("[role=option]");
      if (step) chooseStep(step, true);
    });
  }
  byId("filter").addEventListener("input", listCells);
  if (rows.length) {
    byId("fold").addEventListener("click", () => foldAll(false));
    byId("unfold").addEventListener("click", () => foldAll(true));
    byId("held").addEventListener("change", (event) => {
      main.classList.toggle("held", event.target.checked);
    });
    const failed = rows.find((row) => row.classList.contains("failed"));
    if (failed) chooseRow(failed, false);
    else rows[0].tabIndex = 0;
  }
  if (!rows.some((row) => row.getAttribute("aria-selected") === "true")) {
    if (steps.length) steps[0].tabIndex = 0;
    current = { values: stateAfter(-1), changed: new Map() };
    listChanges(current.changed);
    listCells();
  }
})();
