use bitgrain::*; use bitgrain_kernel::*; use bitgrain::sim::*; use bitgrain_kernel::law::*;
fn main(){
  let a: Vec<String>=std::env::args().collect();
  let f=lammps::read_data(std::path::Path::new(&a[1])).unwrap();
  let n:u64=a[2].parse().unwrap();
  let g=792.44659623055669;
  let law=AnyLaw::HertzHistory(HertzHistory{kn:2e5,kt:2.45e5,gamma_n:g,gamma_t:g,mu:0.5});
  let dom=Domain::new([f.lo[0],f.lo[1],-5.0],[f.hi[0],f.hi[1],200.0],[true,true,false]).unwrap();
  let mut obs=vec![]; let mut pts=vec![];
  for at in &f.atoms { if at.kind==2 { let mut o=Obstacle::sphere(at.position,at.diameter/2.0); o.velocity=[1.0,0.0,0.0]; o.inverse_mass=1.0/sphere_mass(at.diameter,at.density); obs.push(o);} else {pts.push(at)} }
  let rows: Vec<[f64;4]>=pts.iter().map(|p|[p.position[0],p.position[1],p.position[2],0.0]).collect();
  let w: f64 = a.get(3).map(|s|s.parse().unwrap()).unwrap_or(1.0);
  let ord=order::spatial_order(&rows,w);
  let grains: Vec<Grain>=ord.iter().enumerate().map(|(k,&i)|{let p=pts[i]; Grain{id:k as u32+1,group:(p.kind==3) as u8,diameter:p.diameter,density:p.density,position:p.position,velocity:p.velocity,spin:p.spin}}).collect();
  let mut sim=Sim::new(law,dom,1.5e-4,vec![Group::free([0.0,0.0,-1.0]),Group::frozen()],&grains,obs);
  if let Some(s)=a.get(4){sim.skin=s.parse().unwrap();}
  sim.start().unwrap(); sim.steps(500).unwrap();
  let (s0,..)=sim.search_counts();
  let t=std::time::Instant::now(); sim.steps(n).unwrap(); let e=t.elapsed().as_secs_f64();
  let (s1,l,tt)=sim.search_counts();
  let dg=format!("{:02x?}",sim.digest().whole); println!("{:.2} M/s searches {} listed/g {:.2} contacts/g {:.2} touches {} bytes/g {} F {:?} {}", grains.len() as f64*n as f64/e/1e6, s1-s0, l as f64/grains.len() as f64, sim.bonds().len() as f64/grains.len() as f64, tt, sim.bytes()/grains.len(), sim.obstacles[0].force.clone(), &dg[..40]);
}
