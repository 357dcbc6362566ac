// Questions to the server: of each kind one at a time, and of those that wait the last one alone.

const TAB = Array.from(crypto.getRandomValues(new Uint32Array(4)), (n) => n.toString(36)).join("");
const gone = document.getElementById("gone");

function lost(reason) {
  gone.textContent = reason;
  gone.hidden = false;
  document.body.classList.add("is-gone");
}

// { status, data }; status 0 when nobody answers any more.
async function ask(kind, question) {
  let answer;
  try {
    answer = await fetch(`/api/${kind}`, {
      method: "POST",
      headers: { "Content-Type": "application/json", "X-Ptmcad-Secret": DATA.secret },
      body: JSON.stringify({ tab: TAB, ...question }),
    });
    if (answer.status === 403) {
      lost("Another run of the program answers here. Open the address that its terminal shows.");
      return { status: 0, data: {} };
    }
    return { status: answer.status, data: await answer.json() };
  } catch (ended) {
    lost("The program has ended: nothing is computed any more. Start ptmcad explore again, and open its new address.");
    return { status: 0, data: {} };
  }
}

// Asks for the last thing that was wanted, as soon as the question before is answered; a question that may be
// interrupted does not make others wait.
class Latest {
  constructor(kind, answered) {
    Object.assign(this, { kind, answered, under: null, next: null, count: 0 });
  }

  want(question, note = {}) {
    this.next = { question, note, asked: performance.now() };
    if (!this.under || this.under.question.fine) this.go();
  }

  async go() {
    const mine = this.next;
    this.next = null;
    this.under = mine;
    this.count += 1;
    const { status, data } = await ask(this.kind, mine.question);
    if (this.under === mine) this.under = null;
    if (status === 200 || status === 422 || status === 400 || status === 503) {
      if (!this.under) this.answered(status, data, mine);
    }
    if (this.next && !this.under) this.go();
  }
}
