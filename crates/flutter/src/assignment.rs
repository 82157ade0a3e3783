//! Which new root belongs to which mode: the assignment problem, solved to its optimum.

/// Column of each row that minimizes the sum of `cost[row][column]`, for rows <= columns.
///
/// Kuhn's Hungarian method in the form with potentials and shortest augmenting paths (Jonker and Volgenant 1987), O(n^2 m).
/// Ties go to the lower column, so the answer does not depend on anything but the numbers. Costs must be finite.
pub(crate) fn assign(cost: &[Vec<f64>]) -> Vec<usize> {
    let rows = cost.len();
    let columns = cost.first().map_or(0, Vec::len);
    debug_assert!(rows <= columns);
    // Row 0 and column 0 are artificial: they hold the row that is being placed.
    let mut row_potential = vec![0.0; rows + 1];
    let mut column_potential = vec![0.0; columns + 1];
    let mut row_of = vec![0_usize; columns + 1];
    for row in 1..=rows {
        row_of[0] = row;
        let mut least = vec![f64::INFINITY; columns + 1];
        let mut from = vec![0_usize; columns + 1];
        let mut used = vec![false; columns + 1];
        let mut current = 0;
        loop {
            used[current] = true;
            let placed = row_of[current];
            let (mut delta, mut next) = (f64::INFINITY, 0);
            for column in 1..=columns {
                if used[column] {
                    continue;
                }
                let reduced = cost[placed - 1][column - 1] - row_potential[placed] - column_potential[column];
                if reduced < least[column] {
                    least[column] = reduced;
                    from[column] = current;
                }
                if least[column] < delta {
                    delta = least[column];
                    next = column;
                }
            }
            for column in 0..=columns {
                if used[column] {
                    row_potential[row_of[column]] += delta;
                    column_potential[column] -= delta;
                } else {
                    least[column] -= delta;
                }
            }
            current = next;
            if row_of[current] == 0 {
                break;
            }
        }
        while current != 0 {
            row_of[current] = row_of[from[current]];
            current = from[current];
        }
    }
    let mut answer = vec![0; rows];
    for column in 1..=columns {
        if row_of[column] > 0 {
            answer[row_of[column] - 1] = column - 1;
        }
    }
    answer
}

#[cfg(test)]
mod tests {
    use super::assign;

    fn total(cost: &[Vec<f64>], answer: &[usize]) -> f64 {
        answer.iter().enumerate().map(|(r, &c)| cost[r][c]).sum()
    }

    /// Least cost by trying every permutation.
    fn brute(cost: &[Vec<f64>], row: usize, used: &mut Vec<bool>) -> f64 {
        if row == cost.len() {
            return 0.0;
        }
        let mut best = f64::INFINITY;
        for c in 0..used.len() {
            if !used[c] {
                used[c] = true;
                best = best.min(cost[row][c] + brute(cost, row + 1, used));
                used[c] = false;
            }
        }
        best
    }

    #[test]
    fn is_optimal_against_all_permutations() {
        let mut state = 12345_u64;
        let mut random = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f64 / (1_u64 << 24) as f64
        };
        for (rows, columns) in [(1, 1), (2, 2), (3, 5), (5, 5), (6, 7)] {
            for _ in 0..20 {
                let cost: Vec<Vec<f64>> = (0..rows).map(|_| (0..columns).map(|_| random()).collect()).collect();
                let answer = assign(&cost);
                let mut seen = answer.clone();
                seen.sort_unstable();
                seen.dedup();
                assert_eq!(seen.len(), rows);
                assert!((total(&cost, &answer) - brute(&cost, 0, &mut vec![false; columns])).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn greedy_choice_would_be_wrong() {
        assert_eq!(assign(&[vec![0.0, 1.0], vec![0.1, 10.0]]), [1, 0]);
    }
}
