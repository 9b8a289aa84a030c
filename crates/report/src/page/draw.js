"use strict";
// Draws every figure from the JSON beside it. Failures are counted on the root element, where a check can find them.
(function () {
  const root = document.documentElement;
  const plots = Array.from(document.querySelectorAll(".plot"));
  let drawn = 0;
  let failed = 0;
  const config = {
    responsive: true, displaylogo: false, plotlyServerURL: "", showSendToCloud: false, showEditInChartStudio: false,
    modeBarButtonsToRemove: ["select2d", "lasso2d", "autoScale2d"],
    toImageButtonOptions: { format: "svg" },
  };
  function done() {
    root.dataset.drawn = String(drawn);
    root.dataset.failed = String(failed);
  }
  function draw(div) {
    const figure = JSON.parse(document.getElementById(div.id + "-data").textContent);
    return Plotly.newPlot(div, figure.data, figure.layout, config);
  }
  plots.reduce(function (before, div) {
    return before.then(function () { return draw(div); }).then(function () { drawn += 1; }, function (error) {
      failed += 1;
      console.error("figure " + div.id + ": " + error);
      div.classList.add("plain");
      div.textContent = "This figure could not be drawn; its numbers are in the tables and artifacts.";
    });
  }, Promise.resolve()).then(done);
  // Paper is narrower than a window, and plotly does not notice.
  window.addEventListener("beforeprint", function () {
    plots.forEach(function (div) { if (div.layout) { Plotly.relayout(div, { width: 680 }); } });
  });
  window.addEventListener("afterprint", function () {
    plots.forEach(function (div) { if (div.layout) { Plotly.relayout(div, { width: null, autosize: true }); } });
  });
})();
