#[test]
fn explore() {
    for row in verify::coverage(2000, 1) {
        println!("{:20} {:10} {:.3}", row.case, row.interval, row.covered as f64 / row.replications as f64);
    }
}
