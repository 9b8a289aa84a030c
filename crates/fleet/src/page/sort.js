for (const [column, head] of document.querySelectorAll('#runs th').entries()) {
  let rising = false;
  head.onclick = () => {
    rising = !rising;
    const body = document.querySelector('#runs tbody');
    const text = row => row.cells[column].textContent.trim();
    const compare = (a, b) => {
      const [p, q] = [text(a), text(b)];
      if (!p || !q) return !p - !q;
      const order = isNaN(p) || isNaN(q) ? p.localeCompare(q, undefined, { numeric: true }) : p - q;
      return rising ? order : -order;
    };
    body.append(...[...body.rows].sort(compare));
  };
}
