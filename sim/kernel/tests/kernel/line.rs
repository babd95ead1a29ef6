//! Serial lines with blocking: the exact throughputs of Hillier and Boling.

use crate::statistics::Estimate;
use rand::RngExt;
use rand_distr::Exp1;
use toolroom_kernel::{Calendar, Class, Entity, Purpose, Stream, Streams};

#[derive(Clone, Copy, PartialEq)]
enum Station {
    Empty,
    Busy,
    Blocked,
}

/// Parts per time unit of a line that never lacks parts; `buffers[i]` is between `i` and `i + 1`.
fn throughput(rates: &[f64], buffers: &[usize]) -> Estimate {
    let streams = Streams::new(1967, 0);
    let mut service: Vec<Stream> =
        (0..rates.len()).map(|i| streams.open(Entity::named("station").part(i as u64), Purpose::Processing)).collect();
    let mut calendar = Calendar::new();
    let mut stations = vec![Station::Empty; rates.len()];
    let mut filled = vec![0; buffers.len()];
    let (batches, length) = (51, 4000.0);
    let mut finished = vec![0.0; batches];
    let last = rates.len() - 1;
    loop {
        // Dispatch: from the last station up, so that room made downstream is used at once.
        for i in (0..=last).rev() {
            if stations[i] == Station::Blocked && filled[i] < buffers[i] {
                filled[i] += 1;
                stations[i] = Station::Empty;
            }
            // A blocked neighbour hands over directly; the stations before it follow in this loop.
            let part_comes =
                stations[i] == Station::Empty && (i == 0 || filled[i - 1] > 0 || stations[i - 1] == Station::Blocked);
            if part_comes {
                if i > 0 && filled[i - 1] > 0 {
                    filled[i - 1] -= 1;
                } else if i > 0 {
                    stations[i - 1] = Station::Empty;
                }
                stations[i] = Station::Busy;
                let end = calendar.now().after(service[i].sample::<f64, _>(Exp1) / rates[i]).unwrap();
                calendar.schedule(end, Class::Finish, i).unwrap();
            }
        }
        let Some((now, i)) = calendar.pop() else { unreachable!("the first station always has a part") };
        stations[i] = if i == last { Station::Empty } else { Station::Blocked };
        if i == last {
            match finished.get_mut((now.seconds() / length) as usize) {
                Some(count) => *count += 1.0 / length,
                None => return Estimate::of_independent(&finished[1..]),
            }
        }
    }
}

#[test]
fn lines_without_buffers_lose_what_hillier_and_boling_computed() {
    for (stations, exact) in [(2, 0.666_667), (3, 0.564_103), (4, 0.514_775), (5, 0.485_798)] {
        let line = throughput(&vec![1.0; stations], &vec![0; stations - 1]);
        line.assert_agrees(&format!("{stations} stations"), exact, 0.005);
    }
}

#[test]
fn buffers_recover_throughput() {
    let cases: [(&[f64], &[usize], f64); 6] = [
        (&[1.0; 3], &[1, 1], 0.670_466),
        (&[1.0; 3], &[2, 2], 0.734_017),
        (&[1.0, 1.2, 0.9], &[2, 3], 0.768_895),
        (&[1.0; 2], &[1], 0.75),
        (&[1.0; 2], &[5], 0.875),
        (&[1.0; 2], &[10], 0.923_077),
    ];
    for (rates, buffers, exact) in cases {
        throughput(rates, buffers).assert_agrees(&format!("{rates:?} {buffers:?}"), exact, 0.005);
    }
}
