//! Horn and Schunck's energy of a pair of images in f64, and its minimum by conjugate gradients (Hestenes and Stiefel 1952).
//! It shares nothing with the crate but the images.

use viewsphere::frame::Image;

/// Σ (I_x u + I_y v + I_t)² + α² Σ (differences of neighbours)².
pub(crate) struct Energy {
    width: usize,
    height: usize,
    /// I_x, I_y and I_t of each pixel.
    slopes: Vec<[f64; 3]>,
    weight: f64,
}

impl Energy {
    pub(crate) fn new(images: [&Image; 2], alpha: f64) -> Self {
        let (width, height) = (images[0].size.width as usize, images[0].size.height as usize);
        let [first, second] = images.map(|image| smoothed(image, width, height));
        let mean = |x: usize, y: usize| 0.5 * (first[y * width + x] + second[y * width + x]);
        let pixel = |i: usize| {
            let (x, y) = (i % width, i / width);
            let i_x = derivative(|x| mean(x, y), x, width);
            let i_y = derivative(|y| mean(x, y), y, height);
            [i_x, i_y, second[i] - first[i]]
        };
        Self { width, height, slopes: (0..width * height).map(pixel).collect(), weight: alpha * alpha }
    }

    /// Half the energy's slope without its constant part: the matrix of the minimum's equations times a flow.
    fn times(&self, flow: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let brightness = |([i_x, i_y, _], [u, v]): (&[f64; 3], &[f64; 2])| {
            let along = i_x * u + i_y * v;
            [i_x * along, i_y * along]
        };
        let mut product: Vec<[f64; 2]> = self.slopes.iter().zip(flow).map(brightness).collect();
        let mut link = |i: usize, j: usize| {
            for channel in 0..2 {
                let pull = self.weight * (flow[i][channel] - flow[j][channel]);
                product[i][channel] += pull;
                product[j][channel] -= pull;
            }
        };
        for y in 0..self.height {
            for x in 0..self.width {
                let i = y * self.width + x;
                if x + 1 < self.width {
                    link(i, i + 1);
                }
                if y + 1 < self.height {
                    link(i, i + self.width);
                }
            }
        }
        product
    }

    /// The flow of the least energy.
    pub(crate) fn minimum(&self) -> Vec<[f64; 2]> {
        let mut flow = vec![[0.0; 2]; self.slopes.len()];
        let mut residual: Vec<[f64; 2]> =
            self.slopes.iter().map(|[i_x, i_y, i_t]| [-i_x * i_t, -i_y * i_t]).collect();
        let mut direction = residual.clone();
        let first = dot(&residual, &residual);
        let mut square = first;
        for _ in 0..20_000 {
            if square <= 1e-24 * first {
                return flow;
            }
            let product = self.times(&direction);
            let step = square / dot(&direction, &product);
            add(&mut flow, step, &direction);
            add(&mut residual, -step, &product);
            let next = dot(&residual, &residual);
            let share = next / square;
            square = next;
            for (d, r) in direction.as_flattened_mut().iter_mut().zip(residual.as_flattened()) {
                *d = r + share * *d;
            }
        }
        panic!("conjugate gradients have not converged: {square} of {first}");
    }
}

fn dot(a: &[[f64; 2]], b: &[[f64; 2]]) -> f64 {
    a.as_flattened().iter().zip(b.as_flattened()).map(|(a, b)| a * b).sum()
}

fn add(to: &mut [[f64; 2]], factor: f64, of: &[[f64; 2]]) {
    for (a, b) in to.as_flattened_mut().iter_mut().zip(of.as_flattened()) {
        *a += factor * b;
    }
}

/// The image smoothed by [1 2 1] / 4 in both directions, mirrored at the border.
fn smoothed(image: &Image, width: usize, height: usize) -> Vec<f64> {
    let mirrored = |i: isize, n: usize| match i {
        -1 => 1.min(n - 1),
        i if i as usize == n => n.saturating_sub(2),
        i => i as usize,
    };
    let pixel = |i: usize| {
        let mut sum = 0.0;
        for (dy, w_y) in [(-1, 1.0), (0, 2.0), (1, 1.0)] {
            for (dx, w_x) in [(-1, 1.0), (0, 2.0), (1, 1.0)] {
                let x = mirrored((i % width) as isize + dx, width);
                let y = mirrored((i / width) as isize + dy, height);
                sum += w_x * w_y * f64::from(image.data[y * width + x]) / 16.0;
            }
        }
        sum
    };
    (0..width * height).map(pixel).collect()
}

/// The derivative at position `i` of `n`: over five samples, exact to the fourth degree; next to the ends over three, at the
/// ends over two.
fn derivative(sample: impl Fn(usize) -> f64, i: usize, n: usize) -> f64 {
    if i >= 2 && i + 2 < n {
        return (sample(i - 2) - 8.0 * sample(i - 1) + 8.0 * sample(i + 1) - sample(i + 2)) / 12.0;
    }
    let (before, after) = (i.saturating_sub(1), (i + 1).min(n - 1));
    (sample(after) - sample(before)) / (after - before) as f64
}
