// Moves the slider of a page of scenes and says what changed; errors are kept from the start on.
const wrong = [], see = what => wrong.push(String(what));
addEventListener("error", e => see(e.message));
addEventListener("unhandledrejection", e => see(e.reason));
addEventListener("securitypolicyviolation", e => see(e.blockedURI));
console.error = see;

const wait = ms => new Promise(resolve => setTimeout(resolve, ms));

async function until(met) {
  for (let n = 0; n < 50 && !await met(); n++) await wait(200);
}

async function views() {
  const [space, ...others] = plots, z = plot => JSON.stringify(plot.box.data[0].z);
  return {
    cursor: plots.filter(plot => plot.cursor).map(plot => plot.line.offsetLeft),
    frames: others.filter(plot => plot.moves.length).map(z),
    clock: [at("clock").textContent],
    traces: space.box.data.map(one => JSON.stringify(one.x)),
    picture: [await Plotly.toImage(space.box, {width: 400, height: 400})],
  };
}

async function drive() {
  await drawn;
  const before = await views(), moved = {};
  at("time").value = 8;
  at("time").dispatchEvent(new Event("input"));
  await until(async () => {
    const after = await views();
    for (const key in before) moved[key] = before[key].map((one, i) => one !== after[key][i]);
    const {traces, ...others} = moved;
    return traces.some(Boolean) && Object.values(others).flat().every(Boolean);
  });
  const doppler = plots.find(plot => plot.data.length > 1 && plot.cursor).box;
  const visible = () => doppler._fullData.filter(one => one.visible === true).length, hidden = visible();
  for (const kind of ["mousedown", "mouseup"])
    doppler.querySelector(".legendtoggle").dispatchEvent(new MouseEvent(kind, {bubbles: true}));
  await until(() => visible() > hidden);
  const curves = visible() - hidden - 1;  // one is the key of the legend
  await choose(1);
  const headings = plots.slice(1).map(plot => plot.box.querySelector(".gtitle").textContent);
  return {moved, curves, headings, title: document.title, images: document.images.length};
}

addEventListener("load", async () => {
  const found = await drive().catch(see), result = document.createElement("pre");
  result.id = "found";
  result.textContent = JSON.stringify({...found, wrong});
  document.body.append(result);
});
