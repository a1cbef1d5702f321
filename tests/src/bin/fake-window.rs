//! A preview window without a display or a will of its own: a test decides what it sends, and receives its input.
//!
//! `fake-window ADDRESS [deaf]` connects to the test. To there go `pid N`, `in LINE` for each line of its standard input
//! and `end` at that's end; from there come `out LINE` and `err LINE` for its standard output and error, `listen`, and
//! `exit N`. A deaf one reads until the second message, the text, has begun to come, and sends its `pid` then; it reads
//! nothing more before `listen`. It ends with status 0 when the test has gone.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;

fn main() {
    let mut arguments = std::env::args().skip(1);
    let address = arguments.next().expect("the test's address");
    let deaf = arguments.next().is_some_and(|word| word == "deaf");
    let stream = TcpStream::connect(address).expect("the test listens");
    let mut to_test = stream.try_clone().expect("a second handle");
    let mut input = BufReader::new(std::io::stdin());
    let mut read = Vec::new();
    if deaf {
        // The server's thread is within the text from here on: it does not overtake it by another message.
        input.read_until(b'\n', &mut read).expect("a message");
        input.fill_buf().expect("the text");
    }
    writeln!(to_test, "pid {}", std::process::id()).expect("the test reads");
    let (listen, may_listen) = std::sync::mpsc::channel();
    if !deaf {
        listen.send(()).expect("it is received below");
    }
    std::thread::spawn(move || {
        if may_listen.recv().is_err() {
            return;
        }
        let lines = std::io::Cursor::new(read).chain(input).split(b'\n');
        for line in lines.map_while(Result::ok) {
            let whole = [b"in ", &line[..], b"\n"].concat();
            if to_test.write_all(&whole).is_err() {
                return;
            }
        }
        let _ = to_test.write_all(b"end\n");
    });
    for line in BufReader::new(stream).lines().map_while(Result::ok) {
        let (word, rest) = line.split_once(' ').unwrap_or((&line, ""));
        // A server that has gone receives nothing more.
        match word {
            "out" => drop(writeln!(std::io::stdout(), "{rest}")),
            "err" => drop(writeln!(std::io::stderr(), "{rest}")),
            "listen" => drop(listen.send(())),
            "exit" => std::process::exit(rest.parse().expect("a status")),
            _ => panic!("{line}"),
        }
    }
}
