use lab::library::{Entry, Question, ask, by_old_rule, entries};
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let seeds: u64 = args[1].parse().unwrap();
    let only = args.get(2).cloned().unwrap_or_default();
    let entries: Vec<Entry> = entries()
        .into_iter()
        .filter(|e| format!("{:?} {} {}", e.question, e.kind, e.name).contains(&only))
        .collect();
    let t = std::time::Instant::now();
    let rows = ask(&entries, 1..1 + seeds, &|| ());
    for r in &rows {
        println!("{:?} | {} | {} | {:?} | {:?}", r.question, r.kind, r.name, r.total, r.old);
    }
    for q in
        [Question::StrongOrder, Question::WeakOrder, Question::StrongError, Question::Expectation]
    {
        let (mut a, mut m, mut u) = (0, 0, 0);
        for r in rows.iter().filter(|r| r.question == q) {
            a += r.total.asked;
            m += r.total.missed;
            u += r.total.asked - r.total.stated;
        }
        println!("{q:?}: asked {a} missed {m} undecided {u}");
    }
    for r in by_old_rule(&rows) {
        println!("{r:?}");
    }
    println!("{:?}", t.elapsed());
}
