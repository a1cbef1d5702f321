//! A preview window without a display or a will of its own: a test tells it what to say, and hears what it is told.
//!
//! `fake-window ADDRESS [deaf]` connects to the test. To there go `pid N`, `in LINE` for each line of its standard input
//! and `end` at that's end; from there come `out LINE` and `err LINE` for its standard output and error, `listen`, which
//! a deaf one waits for before it reads anything, and `exit N`. It ends with status 0 when the test has gone.

use std::io::{BufRead, BufReader, Write};
use std::net::TcpStream;

fn main() {
    let mut arguments = std::env::args().skip(1);
    let address = arguments.next().expect("the test's address");
    let deaf = arguments.next().is_some_and(|word| word == "deaf");
    let stream = TcpStream::connect(address).expect("the test listens");
    let mut to_test = stream.try_clone().expect("a second handle");
    writeln!(to_test, "pid {}", std::process::id()).expect("the test hears");
    let (listen, may_listen) = std::sync::mpsc::channel();
    if !deaf {
        listen.send(()).expect("it is received below");
    }
    std::thread::spawn(move || {
        if may_listen.recv().is_err() {
            return;
        }
        for line in std::io::stdin().lock().split(b'\n').map_while(Result::ok) {
            let whole = [b"in ", &line[..], b"\n"].concat();
            if to_test.write_all(&whole).is_err() {
                return;
            }
        }
        let _ = to_test.write_all(b"end\n");
    });
    for line in BufReader::new(stream).lines().map_while(Result::ok) {
        let (word, rest) = line.split_once(' ').unwrap_or((&line, ""));
        // A server that has gone hears nothing more.
        match word {
            "out" => drop(writeln!(std::io::stdout(), "{rest}")),
            "err" => drop(writeln!(std::io::stderr(), "{rest}")),
            "listen" => drop(listen.send(())),
            "exit" => std::process::exit(rest.parse().expect("a status")),
            _ => panic!("{line}"),
        }
    }
}
