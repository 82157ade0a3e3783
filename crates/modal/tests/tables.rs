//! Tables of modes: round trip, units, broken input.

use dip_modal::{Modes, TableError, TableOptions};

const WIDE: &str = "# freq_hz: 1, 2.5\n# generalized_mass_kg: 3 4\nnode,x_in,y_in,phi1,phi2\n\
    1,0,0,0.5,-1\n2,10,0,1.5,2\n";

#[test]
fn a_wide_table_is_read_with_its_units_and_written_back() {
    let modes = Modes::from_csv(WIDE, &TableOptions::default()).unwrap();
    assert_eq!(modes.count(), 2);
    assert!((modes.nodes[1].position.x - 0.254).abs() < 1e-15);
    assert_eq!(modes.shapes[1][1][2], 2.0);
    assert_eq!(modes.generalized_mass, [3.0, 4.0]);
    assert!((modes.freq_hz(1) - 2.5).abs() < 1e-15);
    let again = Modes::from_csv(&modes.to_csv(), &TableOptions::default()).unwrap();
    assert_eq!(again, modes);
}

#[test]
fn a_long_table_must_list_the_same_nodes_for_every_mode() {
    let text =
        "mode_zone,node,x_in,y_in,z_in,dx,dy,dz\n1,1,0,0,0,0,0,1\n1,2,1,0,0,0,0,2\n2,1,0,0,0,0,0,3\n2,2,1,0,0,0,0,4\n";
    let options = TableOptions {
        omega_rad_s: vec![1.0, 2.0],
        ..TableOptions::default()
    };
    let modes = Modes::from_csv(text, &options).unwrap();
    assert_eq!(modes.shapes[1][1][2], 4.0);
    assert_eq!(modes.generalized_mass, [1.0, 1.0]);
    let cut = text.rsplit_once("2,2,").unwrap().0;
    assert!(matches!(
        Modes::from_csv(cut, &options),
        Err(TableError::Ragged {
            mode: 2,
            got: 1,
            needed: 2
        })
    ));
    let swapped = text.replace("2,2,1,0", "2,7,1,0");
    let message = Modes::from_csv(&swapped, &options).unwrap_err().to_string();
    assert!(message.contains("line 5") && message.contains("node 2"), "{message}");
}

#[test]
fn broken_tables_say_line_and_need_and_never_panic() {
    let read = |text: &str| Modes::from_csv(text, &TableOptions::default());
    assert!(matches!(read(""), Err(TableError::NoHeader)));
    assert!(matches!(read("node,x_in,phi1\n"), Err(TableError::NoColumn { .. })));
    assert!(matches!(
        read("node,x,y,phi2\n1,0,0,1\n"),
        Err(TableError::NoColumn { .. })
    ));
    assert!(matches!(
        read("node,x,y,phi1\n1,0,0,abc\n"),
        Err(TableError::Line { line: 2, .. })
    ));
    assert!(matches!(
        read("node,x,y,phi1\n1,0\n"),
        Err(TableError::Line { line: 2, .. })
    ));
    assert!(matches!(
        read("node,x,y,phi1\n1,0,0,NaN\n"),
        Err(TableError::Line { line: 2, .. })
    ));
    // No frequency anywhere.
    assert!(matches!(
        read("node,x,y,phi1\n1,0,0,1\n"),
        Err(TableError::Count { got: 0, needed: 1, .. })
    ));
    // Every cut of a good table is read or refused.
    for end in 0..WIDE.len() {
        let _ = read(&WIDE[..end]);
    }
}
