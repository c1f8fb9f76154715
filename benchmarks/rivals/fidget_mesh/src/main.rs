//! Meshes a .vm file with Fidget for each line on stdin: "vm" or "jit". Answers with the CPU seconds
//! and the number of triangles. Arguments: the file and the depth of the octree.

use fidget_core::{context::Context, eval::Function, render::RenderHints, shape::Shape, vm::VmShape};
use fidget_jit::JitShape;
use fidget_mesh::{Mesh, Octree, Settings};
use std::io::Write;

fn cpu_seconds() -> f64 {
    let mut used: libc::rusage = unsafe { std::mem::zeroed() };
    unsafe { libc::getrusage(libc::RUSAGE_SELF, &mut used) };
    let seconds = used.ru_utime.tv_sec + used.ru_stime.tv_sec;
    seconds as f64 + 1e-6 * (used.ru_utime.tv_usec + used.ru_stime.tv_usec) as f64
}

fn meshed<F: Function + RenderHints + Clone>(shape: Shape<F>, depth: u8) -> (Mesh, f64) {
    let bound = shape.try_into().ok().expect("the file has variables");
    let settings = Settings { depth, threads: None, ..Default::default() };
    let begin = cpu_seconds();
    let mesh = Octree::build(&bound, &settings).unwrap().walk_dual();
    (mesh, cpu_seconds() - begin)
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let depth: u8 = arguments[2].parse().unwrap();
    let (context, root) =
        Context::from_text(std::fs::File::open(&arguments[1]).unwrap()).unwrap();
    let vm = VmShape::new(&context, root).unwrap();
    let jit = JitShape::new(&context, root).unwrap();
    for line in std::io::stdin().lines() {
        let (mesh, seconds) = match line.unwrap().trim() {
            "jit" => meshed(jit.clone(), depth),
            _ => meshed(vm.clone(), depth),
        };
        println!("{} {}", seconds, mesh.triangles.len());
        std::io::stdout().flush().unwrap();
    }
}
