import { shortNumber } from "./fields";
import type { Head } from "./head";

/// Numbers and texts of nested JSON as rows: group, name, value. Lists are left out.
export function flatten(json: Record<string, unknown>, group: string): [string, string, string][] {
  const rows: [string, string, string][] = [];
  for (const [name, value] of Object.entries(json)) {
    if (typeof value === "number") rows.push([group, name, shortNumber(value)]);
    else if (typeof value === "string" && value !== "") rows.push([group, name, value]);
    else if (typeof value === "boolean") rows.push([group, name, value ? "yes" : "no"]);
    else if (Array.isArray(value) && value.every((item) => typeof item === "number"))
      rows.push([group, name, value.map(shortNumber).join(", ")]);
    else if (value !== null && typeof value === "object" && !Array.isArray(value))
      rows.push(...flatten(value as Record<string, unknown>, name));
  }
  return rows;
}

function bodyRows(head: Head): [string, string, string][] {
  type Body = { name: string; vertices: number; elements: number; material: Record<string, unknown> };
  const bodies = (head.scene?.bodies ?? []) as Body[];
  return bodies.slice(0, 50).map((body) => {
    const material = flatten(body.material, "").map(([, name, value]) => `${name} ${value}`);
    return ["bodies", body.name, `${body.vertices} vertices, ${body.elements} elements; ${material.join(", ")}`];
  });
}

/// All that a page knows in numbers, as a table.
export function detailRows(head: Head): [string, string, string][] {
  const rows = head.facts.map((fact) => [...fact] as [string, string, string]);
  if (head.summary) rows.push(...flatten(head.summary, "run"));
  if (head.scene) rows.push(...flatten(head.scene, "scene"), ...bodyRows(head));
  rows.push(["page", "written by", `selvage ${head.version}`], ["page", "vertices shown", `${head.vertices} of ${head.vertices_of_mesh}`]);
  rows.push(["page", "triangles", `${head.triangles}`], ["page", "poses", `${head.times.length}`]);
  const known = new Set<string>();
  return rows.filter(([, name, value]) => {
    if (name === "schema" || name === "kind" || known.has(`${name} ${value}`)) return false;
    known.add(`${name} ${value}`);
    return true;
  });
}

export function fillDetails(parent: HTMLElement, head: Head): void {
  const groups = new Map<string, [string, string, string][]>();
  for (const row of detailRows(head)) groups.set(row[0], [...(groups.get(row[0]) ?? []), row]);
  for (const [group, rows] of groups) {
    const title = Object.assign(document.createElement("h2"), { textContent: group.replaceAll("_", " ") });
    const table = document.createElement("table");
    for (const [, name, value] of rows) {
      const line = table.insertRow();
      line.append(Object.assign(document.createElement("th"), { textContent: name.replaceAll("_", " "), scope: "row" }));
      line.insertCell().textContent = value;
    }
    parent.append(title, table);
  }
}
