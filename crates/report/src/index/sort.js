// Heads of columns become buttons that sort the rows; rows without a value stay at the end.
for (const table of document.querySelectorAll('table.index')) {
  const heads = [...table.tHead.rows[0].cells];
  const body = table.tBodies[0];
  heads.forEach((head, column) => {
    if ('fixed' in head.dataset) return;
    const button = document.createElement('button');
    button.type = 'button';
    button.append(...head.childNodes);
    head.append(button);
    button.addEventListener('click', () => {
      const rising = head.getAttribute('aria-sort') !== 'ascending';
      heads.forEach((other) => other.removeAttribute('aria-sort'));
      head.setAttribute('aria-sort', rising ? 'ascending' : 'descending');
      const text = (row) => row.cells[column].textContent.trim();
      const compare = ([a], [b]) => {
        if (!a || !b) return !a - !b;
        const [p, q] = [a, b].map((x) => Number(x.replace('−', '-').replace(',', '.')));
        const order = isNaN(p) || isNaN(q) ? a.localeCompare(b, document.documentElement.lang, { numeric: true }) : p - q;
        return rising ? order : -order;
      };
      body.append(...[...body.rows].map((row) => [text(row), row]).sort(compare).map(([, row]) => row));
    });
  });
}
document.documentElement.classList.add('sorts');
