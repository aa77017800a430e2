// Looks through the report in the frame `page` and writes what is wrong into the element `finds`, a line each.

const frame = document.getElementById("page");
// Before the page is read there is an empty one, whose window stays: errors of loading arrive too.
frame.contentWindow.onerror = (message) => say(`page error: ${message}`);
window.onerror = (message) => say(`wrapper error: ${message}`);
frame.onload = () => {
  look(frame.contentWindow);
  document.getElementById("finds").textContent = "\n" + finds.join("\n") + "\n";
};
