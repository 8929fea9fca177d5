//! Cards of NVIDIA by their driver.

use std::{
    collections::HashMap,
    sync::{Arc, Mutex, PoisonError},
};

use cudarc::{
    driver::{
        CudaContext, CudaFunction, CudaSlice, CudaStream, DriverError, LaunchConfig, PushKernelArg,
        sys::{self, CUdevice_attribute, CUresult},
    },
    nvrtc::Ptx,
};

use crate::{Failure, Machine, March, NAME};

/// Threads of a block, four warps: a group of paths.
const BLOCK: u32 = 128;

/// A card.
pub struct Card {
    context: Arc<CudaContext>,
    stream: Arc<CudaStream>,
    /// Kernels by their texts, each loaded once.
    kernels: Mutex<HashMap<String, CudaFunction>>,
}

impl From<DriverError> for Failure {
    fn from(error: DriverError) -> Self {
        let why = format!("{error}");
        match error.0 {
            CUresult::CUDA_ERROR_OUT_OF_MEMORY => Self::Memory(why),
            CUresult::CUDA_ERROR_LAUNCH_TIMEOUT => Self::Stopped(why),
            CUresult::CUDA_ERROR_NO_DEVICE | CUresult::CUDA_ERROR_NOT_INITIALIZED => {
                Self::None(why)
            }
            _ => Self::Other(why),
        }
    }
}

impl Card {
    /// The first card.
    ///
    /// # Errors
    /// [`Failure::None`] without a driver or a card.
    pub fn first() -> Result<Self, Failure> {
        // SAFETY: the library is opened and closed again, and nothing of it is called.
        #[allow(unsafe_code)]
        let has_driver = unsafe { sys::is_culib_present() };
        if !has_driver {
            return Err(Failure::None("the driver of NVIDIA, libcuda, is not installed".into()));
        }
        let context = CudaContext::new(0)?;
        let stream = context.new_stream()?;
        Ok(Self { context, stream, kernels: Mutex::default() })
    }

    fn kernel(&self, ptx: &str) -> Result<CudaFunction, Failure> {
        let mut kernels = self.kernels.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(kernel) = kernels.get(ptx) {
            return Ok(kernel.clone());
        }
        let kernel = self.context.load_module(Ptx::from_src(ptx))?.load_function(NAME)?;
        kernels.insert(ptx.into(), kernel.clone());
        Ok(kernel)
    }
}

struct OnCard {
    stream: Arc<CudaStream>,
    kernel: CudaFunction,
    paths: u64,
    memory: CudaSlice<u64>,
    states: CudaSlice<f64>,
}

/// Ratio of rates in single and in double precision beyond which a card is slow.
const SLOW: i32 = 8;

impl Machine for Card {
    fn about(&self) -> String {
        let of = || {
            let attribute =
                CUdevice_attribute::CU_DEVICE_ATTRIBUTE_SINGLE_TO_DOUBLE_PRECISION_PERF_RATIO;
            let ratio = self.context.attribute(attribute)?;
            let slow = match ratio > SLOW {
                true => format!(", of which double precision has 1/{ratio} of the rate of single"),
                false => String::new(),
            };
            let gigabytes = self.context.total_mem()? as f64 / f64::from(1 << 30);
            Ok::<_, DriverError>(format!("{}, {gigabytes:.0} GB{slow}", self.context.name()?))
        };
        of().unwrap_or_else(|error| error.to_string())
    }

    fn fewest(&self) -> u64 {
        1 << 11
    }

    fn begin(
        &self,
        ptx: &str,
        paths: u64,
        memory: Vec<u64>,
        states: usize,
    ) -> Result<Box<dyn March + '_>, Failure> {
        let (stream, kernel) = (Arc::clone(&self.stream), self.kernel(ptx)?);
        let memory = stream.clone_htod(&memory)?;
        let states = stream.alloc_zeros(states.max(1))?;
        Ok(Box::new(OnCard { stream, kernel, paths, memory, states }))
    }
}

impl March for OnCard {
    #[allow(unsafe_code)]
    fn launch(
        &mut self,
        before: u64,
        steps: u64,
        numbers: &[f64],
        slots: &[u64],
    ) -> Result<(), Failure> {
        let Self { stream, kernel, paths, memory, states } = self;
        let (numbers, slots) = (stream.clone_htod(numbers)?, stream.clone_htod(slots)?);
        let mut launch = stream.launch_builder(kernel);
        launch.arg(memory).arg(states).arg(&numbers).arg(&slots);
        launch.arg(&*paths).arg(&before).arg(&steps);
        let blocks = paths.div_ceil(u64::from(BLOCK)) as u32;
        let shape = LaunchConfig {
            grid_dim: (blocks, 1, 1),
            block_dim: (BLOCK, 1, 1),
            shared_mem_bytes: 0,
        };
        // SAFETY: the arguments are those of `PARAMETERS` in their order and of 64 bits each. The
        // kernel is of `kernel.rs`: a thread with the number of a path writes the column of its
        // path in the memory, whose rows are those of `memory_rows`, and in the states at slots
        // that were given out for them; it reads the tables of numbers up to the last step of the
        // launch, which are there. Nothing of these is freed or read before the stream is done.
        unsafe { launch.launch(shape) }?;
        stream.synchronize()?;
        Ok(())
    }

    fn end(self: Box<Self>) -> Result<(Vec<u64>, Vec<f64>), Failure> {
        Ok((self.stream.clone_dtoh(&self.memory)?, self.stream.clone_dtoh(&self.states)?))
    }
}
