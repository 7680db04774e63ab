/** Of traces: told apart on light and dark ground. */
export const colours = ["#2f9e6e", "#d9822b", "#5b8def", "#d64f7f", "#9b6dd7", "#b59a00", "#00a3b5", "#8a8f98"];
